#pragma once
// Edits with a client identity: each has a sequence, so a repeated edit is applied once, and results name the sequence
// up to which they contain this client's edits.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lpv/client.h"
#include "lpv/latency.h"

namespace lpv::client {

/// A member of a session. join() joins; leave() ends the membership and keeps the edits.
/// Only one thread at a time may edit through an Editor and the EditStream made from it.
class Editor {
 public:
  /// Joins the session. With a display name the other members see this one in presence at once.
  static Expected<Editor> join(Client client, const std::string& session, const std::string& displayName);
  /// Resumes a member that joined before, possibly in another process. `lastSequence`: at least the sequence of its
  /// last edit. With an empty identity edits are anonymous: they are not retried and cannot be undone.
  static Editor resume(Client client, const std::string& session, v1::ClientIdentity identity,
                       std::uint64_t lastSequence);

  /// Applies one edit and waits for the answer. If the connection breaks before the answer, the same sequence is sent
  /// again until the client's timeout, and is applied once. A refused edit returns its error and changes nothing.
  Expected<v1::EditAck> apply(v1::Edit edit);

  /// Undoes this member's newest undo step, or redoes the one undone last. drain() an EditStream first: undo does not
  /// wait for its edits in flight. FAILED_PRECONDITION if there is no step. Fields that another member has written
  /// since keep their values and are listed in skipped_fields. Retries as apply() does.
  Expected<v1::UndoResponse> undo();
  Expected<v1::RedoResponse> redo();

  /// Publishes this member's camera and selection to the other members. RESOURCE_EXHAUSTED
  /// (max_presence_updates_per_second) if called too often: send the newest state a little later.
  Status present(const v1::Presence& presence);

  /// Locks lights and surfaces against changes by other members for 1 to 60 s, or extends such a lock; 0 s releases it,
  /// and with no objects named all locks of this member. ABORTED if another member has locked one of them; none is
  /// locked then.
  Status lock(const std::vector<std::string>& objects, std::chrono::seconds time);

  Status leave();

  const std::string& session() const { return session_; }
  const v1::ClientIdentity& identity() const { return identity_; }
  const Client& client() const { return client_; }
  /// Sequence of the last edit.
  std::uint64_t sequence() const { return *sequence_; }

 private:
  friend class EditStream;
  Editor(Client client, std::string session, v1::ClientIdentity identity);

  Client client_;
  std::string session_;
  v1::ClientIdentity identity_;
  std::shared_ptr<std::uint64_t> sequence_;
};

/// A stream of edits in order that does not wait for each answer, for interactive editors. It reconnects by itself and
/// resends the edits that were not acknowledged.
class EditStream {
 public:
  /// Called for each acknowledgement, in order, on the stream's thread. A rejected edit is acknowledged with a status
  /// other than OK.
  using OnAck = std::function<void(const v1::EditAck&)>;
  /// Called once if the stream ends with an error that reconnecting cannot cure.
  using OnEnd = std::function<void(const Status&)>;

  /// `latency` records when each edit is sent; pass the same object to a watcher's hooks.
  EditStream(const Editor& editor, OnAck onAck = {}, OnEnd onEnd = {}, std::shared_ptr<LatencyLog> latency = {});
  ~EditStream();
  EditStream(const EditStream&) = delete;
  EditStream& operator=(const EditStream&) = delete;

  /// Sends an edit and returns its sequence. Blocks while 256 edits are unanswered. Errors: why the stream ended.
  Expected<std::uint64_t> send(v1::Edit edit);

  /// Waits until all edits sent are acknowledged; DEADLINE_EXCEEDED after `timeout`.
  Status drain(std::chrono::milliseconds timeout);

  /// Ends the stream; unacknowledged edits may or may not have been applied.
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lpv::client
