#pragma once
// Edits with an identity: each has a sequence, so a repeated one is applied once, and results say which they contain.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lpv/client.h"
#include "lpv/latency.h"

namespace lpv::client {

/// A member of a session. Joined on creation; leave() gives the identity back (its edits stay).
/// One thread at a time edits through an Editor and the EditStream made from it.
class Editor {
 public:
  /// With a display name the other members see this one at once (Presence).
  static Expected<Editor> join(Client client, const std::string& session, const std::string& displayName);
  /// A member that joined before, perhaps in another process. `lastSequence`: at least that of its last edit. An empty
  /// identity edits as nobody: nothing is repeated, nothing can be undone.
  static Editor resume(Client client, const std::string& session, v1::ClientIdentity identity,
                       std::uint64_t lastSequence);

  /// One edit, answered. Where the connection breaks before the answer, the same sequence is sent again until the
  /// client's timeout: it is applied once. A refused edit is the error and changes nothing.
  Expected<v1::EditAck> apply(v1::Edit edit);

  /// Takes back this member's newest step, or makes one again. With an EditStream, drain() it first: undo does not wait
  /// for what is on its way there. FAILED_PRECONDITION where there is nothing. What somebody else has written since
  /// stays, and is named in skipped_fields. The same retries as apply().
  Expected<v1::UndoResponse> undo();
  Expected<v1::RedoResponse> redo();

  /// Tells the other members where this one looks and what it has selected. RESOURCE_EXHAUSTED
  /// (max_presence_updates_per_second) where that comes too often: send the newest a little later.
  Status present(const v1::Presence& presence);

  /// Keeps the others from changing lights and surfaces for 1 to 60 s, or as long again; 0 s releases them, all of this
  /// member's where none is named. ABORTED where another member has one: none of them is locked then.
  Status lock(const std::vector<std::string>& objects, std::chrono::seconds time);

  Status leave();

  const std::string& session() const { return session_; }
  const v1::ClientIdentity& identity() const { return identity_; }
  const Client& client() const { return client_; }
  /// The sequence of the last edit made.
  std::uint64_t sequence() const { return *sequence_; }

 private:
  friend class EditStream;
  Editor(Client client, std::string session, v1::ClientIdentity identity);

  Client client_;
  std::string session_;
  v1::ClientIdentity identity_;
  std::shared_ptr<std::uint64_t> sequence_;
};

/// Edits in order without waiting for each answer: what an interactive editor wants. Reconnects by itself and sends
/// again what was not acknowledged.
class EditStream {
 public:
  /// Called for each acknowledgement, in order, on the stream's thread; a rejection is an acknowledgement whose status
  /// is not OK.
  using OnAck = std::function<void(const v1::EditAck&)>;
  /// Called once if the stream ends for a reason that reopening cannot cure.
  using OnEnd = std::function<void(const Status&)>;

  /// `latency`, where given, is told when each edit is sent; give the same to a watcher.
  EditStream(const Editor& editor, OnAck onAck = {}, OnEnd onEnd = {}, std::shared_ptr<LatencyLog> latency = {});
  ~EditStream();
  EditStream(const EditStream&) = delete;
  EditStream& operator=(const EditStream&) = delete;

  /// Sends an edit and returns its sequence. Waits while 256 edits are unanswered. The error is why the stream ended.
  Expected<std::uint64_t> send(v1::Edit edit);

  /// Waits until everything sent is acknowledged; DEADLINE_EXCEEDED after `timeout`.
  Status drain(std::chrono::milliseconds timeout);

  /// Ends the stream; unacknowledged edits may or may not have been applied.
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lpv::client
