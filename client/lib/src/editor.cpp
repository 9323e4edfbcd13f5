#include "lpv/editor.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include "connection.h"
#include "reconnect_loop.h"

namespace lpv::client {
namespace {

using namespace std::chrono_literals;

/// The server, too, stops reading at this number of queued edits.
constexpr std::size_t kMaxUnanswered = 256;
constexpr int kAttempts = 4;

/// Repeats a call whose answer was lost. Its sequence makes sure that the edit is applied once.
template <typename Request, typename Response>
Expected<Response> retryWhileUnavailable(Connection& connection,
                                         grpc::Status (v1::SceneService::Stub::*method)(grpc::ClientContext*,
                                                                                        const Request&, Response*),
                                         const Request& request) {
  for (int attempt = 1;; ++attempt) {
    auto response = unary(connection, *connection.scene, method, request);
    if (response || response.status().code() != Code::kUnavailable || attempt == kAttempts) return response;
    std::this_thread::sleep_for(100ms * attempt);
  }
}

}  // namespace

Editor::Editor(Client client, std::string session, v1::ClientIdentity identity)
    : client_(std::move(client)),
      session_(std::move(session)),
      identity_(std::move(identity)),
      sequence_(std::make_shared<std::uint64_t>(0)) {}

Expected<Editor> Editor::join(Client client, const std::string& session, const std::string& displayName) {
  v1::JoinSessionRequest request;
  request.set_session(sessionName(session));
  request.set_display_name(displayName);
  Connection& connection = *client.connection();
  auto response = unary(connection, *connection.sessions, &v1::SessionService::Stub::JoinSession, request);
  if (!response) return response.status();
  return Editor(std::move(client), request.session(), response->client());
}

Editor Editor::resume(Client client, const std::string& session, v1::ClientIdentity identity,
                      std::uint64_t lastSequence) {
  Editor out(std::move(client), sessionName(session), std::move(identity));
  *out.sequence_ = lastSequence;
  return out;
}

Expected<v1::EditAck> Editor::apply(v1::Edit edit) {
  if (identity_.client_id().empty()) return client_.applyEdit(session_, edit);
  edit.set_sequence(++*sequence_);
  v1::ApplyEditRequest request;
  request.set_session(session_);
  *request.mutable_client() = identity_;
  *request.mutable_edit() = std::move(edit);
  const auto response = retryWhileUnavailable(*client_.connection(), &v1::SceneService::Stub::ApplyEdit, request);
  if (!response) return response.status();
  return response->ack();
}

Expected<v1::UndoResponse> Editor::undo() {
  v1::UndoRequest request;
  request.set_session(session_);
  *request.mutable_client() = identity_;
  request.set_sequence(++*sequence_);
  return retryWhileUnavailable(*client_.connection(), &v1::SceneService::Stub::Undo, request);
}

Expected<v1::RedoResponse> Editor::redo() {
  v1::RedoRequest request;
  request.set_session(session_);
  *request.mutable_client() = identity_;
  request.set_sequence(++*sequence_);
  return retryWhileUnavailable(*client_.connection(), &v1::SceneService::Stub::Redo, request);
}

Status Editor::present(const v1::Presence& presence) {
  v1::UpdatePresenceRequest request;
  request.set_session(session_);
  *request.mutable_client() = identity_;
  *request.mutable_presence() = presence;
  Connection& connection = *client_.connection();
  return unary(connection, *connection.sessions, &v1::SessionService::Stub::UpdatePresence, request).status();
}

Status Editor::lock(const std::vector<std::string>& objects, std::chrono::seconds time) {
  v1::LockObjectsRequest request;
  request.set_session(session_);
  *request.mutable_client() = identity_;
  for (const std::string& name : objects) request.add_objects(name);
  request.mutable_ttl()->set_seconds(time.count());
  Connection& connection = *client_.connection();
  return unary(connection, *connection.scene, &v1::SceneService::Stub::LockObjects, request).status();
}

Status Editor::leave() {
  v1::LeaveSessionRequest request;
  request.set_session(session_);
  *request.mutable_client() = identity_;
  Connection& connection = *client_.connection();
  return unary(connection, *connection.sessions, &v1::SessionService::Stub::LeaveSession, request).status();
}

struct EditStream::State {
  using Stream = grpc::ClientReaderWriter<v1::StreamEditsRequest, v1::StreamEditsResponse>;

  State(const Editor& editor, OnAck ack, OnEnd end, std::shared_ptr<LatencyLog> log)
      : connection(editor.client().connection()),
        session(editor.session()),
        identity(editor.identity()),
        sequence(editor.sequence_),
        onAck(std::move(ack)),
        onEnd(std::move(end)),
        latency(std::move(log)),
        loop(connection, {[this](grpc::ClientContext& context) { return attempt(context); },
                          {},
                          [this](const Status& status) { finish(status); }}) {
    loop.start();
  }

  grpc::Status attempt(grpc::ClientContext& context) {
    const std::unique_ptr<Stream> open = connection->scene->StreamEdits(&context);
    sendPending(*open);
    v1::StreamEditsResponse response;
    bool known = true;
    while (loop.read(*open, response)) {
      if (!response.has_ack() || !known) continue;
      known = response.ack().status().code() != int(Code::kUnavailable);
      if (known) {
        acknowledge(response.ack());
      } else {
        context.TryCancel();  // makes the loop reconnect and resend unanswered edits
      }
    }
    {
      const std::lock_guard lock(writing);
      stream = nullptr;
    }
    return open->Finish();
  }

  /// Sends the first message, then all unanswered edits in order. New edits wait until that is done.
  void sendPending(Stream& open) {
    const std::lock_guard lock(writing);
    v1::StreamEditsRequest first;
    first.set_session(session);
    *first.mutable_client() = identity;
    bool writable = loop.write(open, first);
    std::deque<v1::Edit> edits;
    {
      const std::lock_guard stateLock(mutex);
      edits = unanswered;
    }
    for (const v1::Edit& edit : edits) writable = writable && loop.write(open, requestOf(edit));
    stream = &open;
  }

  static v1::StreamEditsRequest requestOf(const v1::Edit& edit) {
    v1::StreamEditsRequest request;
    *request.mutable_edit() = edit;
    return request;
  }

  void acknowledge(const v1::EditAck& ack) {
    {
      const std::lock_guard lock(mutex);
      if (unanswered.empty() || ack.sequence() < unanswered.front().sequence()) return;  // repeated acknowledgement
      while (!unanswered.empty() && unanswered.front().sequence() <= ack.sequence()) unanswered.pop_front();
    }
    changed.notify_all();
    if (onAck) onAck(ack);
  }

  void finish(const Status& status) {
    {
      const std::lock_guard lock(mutex);
      ended = status.ok() ? Status(Code::kUnavailable, "the edit stream has ended") : status;
    }
    changed.notify_all();
    if (onEnd) onEnd(status);
  }

  std::shared_ptr<Connection> connection;
  std::string session;
  v1::ClientIdentity identity;
  std::shared_ptr<std::uint64_t> sequence;
  OnAck onAck;
  OnEnd onEnd;
  std::shared_ptr<LatencyLog> latency;

  std::mutex writing;         ///< serialises sending; locked before mutex
  Stream* stream = nullptr;
  std::mutex mutex;           ///< guards unanswered, ended
  std::condition_variable changed;
  std::deque<v1::Edit> unanswered;
  Status ended;
  ReconnectLoop loop;             ///< last member: its thread uses all others
};

EditStream::EditStream(const Editor& editor, OnAck onAck, OnEnd onEnd, std::shared_ptr<LatencyLog> latency)
    : state_(std::make_unique<State>(editor, std::move(onAck), std::move(onEnd), std::move(latency))) {}

EditStream::~EditStream() = default;

Expected<std::uint64_t> EditStream::send(v1::Edit edit) {
  {
    std::unique_lock lock(state_->mutex);
    state_->changed.wait(lock, [&] { return state_->unanswered.size() < kMaxUnanswered || !state_->ended.ok(); });
  }
  const std::lock_guard order(state_->writing);
  {
    const std::lock_guard lock(state_->mutex);
    if (!state_->ended.ok()) return state_->ended;
    edit.set_sequence(++*state_->sequence);
    state_->unanswered.push_back(edit);
  }
  if (state_->latency) state_->latency->sent(edit.sequence());
  // A failed write shows in the next Read, after which the edit is resent.
  if (state_->stream != nullptr) state_->stream->Write(State::requestOf(edit));
  return edit.sequence();
}

Status EditStream::drain(std::chrono::milliseconds timeout) {
  std::unique_lock lock(state_->mutex);
  const auto over = [&] { return state_->unanswered.empty() || !state_->ended.ok(); };
  if (!state_->changed.wait_for(lock, timeout, over)) {
    return Status(Code::kDeadlineExceeded,
                  std::to_string(state_->unanswered.size()) + " edits are not acknowledged yet");
  }
  return state_->unanswered.empty() ? Status() : state_->ended;
}

void EditStream::stop() {
  state_->loop.stop();
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->ended.ok()) state_->ended = Status(Code::kCancelled, "the edit stream was stopped");
  }
  state_->changed.notify_all();
}

}  // namespace lpv::client
