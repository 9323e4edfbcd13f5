#include "api/results/heartbeat.h"

namespace lpv::api {

void HeartbeatEmitter::start(std::function<void()> wake) {
  {
    const MutexLock lock(state_->mutex);
    state_->wake = std::move(wake);
  }
  beatLater(state_);
}

void HeartbeatEmitter::stop() {
  state_->deadline.stop();
  const MutexLock lock(state_->mutex);
  state_->wake = nullptr;
}

void HeartbeatEmitter::close(Closing why) {
  {
    const MutexLock lock(state_->mutex);
    if (!state_->closing) state_->closing = why;
  }
  wake(*state_);
}

void HeartbeatEmitter::quiet() {
  const MutexLock lock(state_->mutex);
  state_->beatDue = false;
}

bool HeartbeatEmitter::over() const {
  const MutexLock lock(state_->mutex);
  return state_->over;
}

Status HeartbeatEmitter::endStatus() const {
  const MutexLock lock(state_->mutex);
  if (state_->closing == Closing::kEncodingFailed) {
    return Status(Code::kInternal, Reason::kEncodingFailed, "a frame could not be encoded; the server's log says why");
  }
  if (state_->closing == Closing::kClientClosed) return {};
  return Status(Code::kUnavailable, "the session has ended here; see the notice");
}

void HeartbeatEmitter::beatLater(const std::shared_ptr<State>& state) {
  state->deadline.restart(kHeartbeatInterval, [weak = std::weak_ptr<State>(state)] {
    const std::shared_ptr<State> self = weak.lock();
    if (!self) return;
    {
      const MutexLock lock(self->mutex);
      if (!self->wake) return;
      self->beatDue = true;
    }
    wake(*self);
    beatLater(self);
  });
}

void HeartbeatEmitter::wake(State& state) {
  std::function<void()> call;
  {
    const MutexLock lock(state.mutex);
    call = state.wake;
  }
  if (call) call();
}

std::optional<Closing> HeartbeatEmitter::takeClosing() {
  const MutexLock lock(state_->mutex);
  if (!state_->closing || state_->over) return std::nullopt;
  state_->over = true;
  return state_->closing;
}

bool HeartbeatEmitter::takeBeat() {
  const MutexLock lock(state_->mutex);
  return std::exchange(state_->beatDue, false) && !state_->over;
}

bool HeartbeatEmitter::takeReadOnly(bool readOnly) {
  const MutexLock lock(state_->mutex);
  return std::exchange(state_->readOnly, readOnly) != readOnly;
}

void HeartbeatEmitter::fillNotice(bool readOnly, pb::Notice* out) {
  out->set_kind(readOnly ? pb::Notice::KIND_READ_ONLY : pb::Notice::KIND_READ_WRITE);
  out->set_message(readOnly ? "the state directory cannot be written: edits are refused for now"
                            : "the state directory can be written again");
}

void HeartbeatEmitter::fillNotice(Closing why, pb::Notice* out) {
  switch (why) {
    case Closing::kDeleted:
      out->set_kind(pb::Notice::KIND_DELETED);
      return out->set_message("the session was deleted");
    case Closing::kEvicted:
      out->set_kind(pb::Notice::KIND_EVICTED);
      return out->set_message("the session was idle and is being evicted; open it again");
    case Closing::kEncodingFailed:
      out->set_kind(pb::Notice::KIND_FAILED);
      return out->set_message("a frame could not be encoded; this stream ends, the session goes on");
    case Closing::kClientClosed:
      out->set_kind(pb::Notice::KIND_CLIENT_CLOSED);
      return out->set_message(
          "the client has closed its side, which ends this stream: keep it open, and acknowledge, to get results");
    case Closing::kDraining:
      out->set_kind(pb::Notice::KIND_DRAINING);
      return out->set_message("the server is draining");
  }
}

void HeartbeatEmitter::fillHeartbeat(const Session& session, pb::Heartbeat* out) {
  out->set_epoch(session.epoch());
  out->set_revision(session.revision());
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  out->set_server_time_ns(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
}

}  // namespace lpv::api
