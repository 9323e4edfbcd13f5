// Scene changes as a stream: made from current state when the reader can take them, so a slow reader costs no memory.

#include <deque>
#include <optional>

#include "api/presence_feed.h"
#include "api/results/heartbeat.h"
#include "api/services.h"
#include "convert/scene.h"
#include "convert/session.h"

namespace lpv::api {
namespace {

class SceneStream final : public StreamOf<SceneStream, pb::WatchSceneRequest, pb::WatchSceneResponse> {
 public:
  explicit SceneStream(const Context& context) : context_(context), heartbeat_(*context.timers) {}

  void receive(pb::WatchSceneRequest request) override {
    if (Status s = open(request); !s.ok()) return end(s);
    wake();
  }

  bool next(pb::WatchSceneResponse* response) override {
    const MutexLock lock(mutex_);
    if (!session_) return false;
    if (heartbeat_.over()) {
      endInNext(Status(Code::kUnavailable, "the session has ended here; see the notice"));
      return false;
    }
    if (parts_.empty()) refill();
    if (parts_.empty()) return nextNotice(response);
    response->Swap(&parts_.front());
    parts_.pop_front();
    heartbeat_.quiet();
    return true;
  }

  void release() override {
    heartbeat_.stop();
    SessionPtr session;
    std::uint64_t watcher = 0;
    {
      const MutexLock lock(mutex_);
      session = session_;
      watcher = watcher_;
    }
    if (session) session->unwatch(watcher);
  }

 private:
  Status open(const pb::WatchSceneRequest& request) {
    const Expected<SessionPtr> session = findSession(context_, "session", request.session());
    if (!session) return session.status();
    if (Status s = (*session)->verify(fromProto(request.client())); !s.ok()) return s;
    const MutexLock lock(mutex_);
    sent_ = request.since_revision();
    session_ = *session;
    snapshotDue_ = sent_ == 0 || (request.since_epoch() != 0 && request.since_epoch() != session_->epoch());
    const auto close = whileAlive([](SceneStream& self, Closing why) { self.heartbeat_.close(why); });
    presence_.start(request.client().client_id());
    watcher_ = session_->watch(wakeWhileAlive(), close, request.client().client_id());
    heartbeat_.start(wakeWhileAlive());
    return {};
  }

  /// Everything since what was sent, as messages. An empty session at revision 0 is told as a snapshot once.
  void refill() LPV_REQUIRES(mutex_) {
    if (!snapshotDue_ && session_->revision() == sent_) return;
    std::map<std::string, std::uint64_t> sequences;
    const Changes changes = session_->changesSince(snapshotDue_ ? std::nullopt : std::optional(sent_), &sequences);
    for (pb::WatchSceneResponse& part : toProto(changes, session_->epoch(), sent_, sequences)) {
      parts_.push_back(std::move(part));
    }
    sent_ = changes.revision;
    snapshotDue_ = false;
  }

  /// What is no change of the scene. Members are told where the reader has taken everything else.
  bool nextNotice(pb::WatchSceneResponse* response) LPV_REQUIRES(mutex_) {
    pb::Presence member;
    if (!presence_.next(*session_, &member)) return heartbeat_.next(*session_, response);
    *response->mutable_presence() = std::move(member);
    heartbeat_.quiet();
    return true;
  }

  const Context context_;
  HeartbeatEmitter heartbeat_;
  Mutex mutex_;
  SessionPtr session_ LPV_GUARDED_BY(mutex_);
  std::uint64_t watcher_ LPV_GUARDED_BY(mutex_) = 0;
  std::uint64_t sent_ LPV_GUARDED_BY(mutex_) = 0;
  bool snapshotDue_ LPV_GUARDED_BY(mutex_) = false;
  PresenceFeed presence_ LPV_GUARDED_BY(mutex_);
  std::deque<pb::WatchSceneResponse> parts_ LPV_GUARDED_BY(mutex_);
};

}  // namespace

StreamPtr<pb::WatchSceneRequest, pb::WatchSceneResponse> watchScene(const Context& context) {
  return std::make_shared<SceneStream>(context);
}

}  // namespace lpv::api
