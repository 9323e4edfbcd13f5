// Long probes: any number of points in parts, every part answered from the same result.

#include <deque>

#include "api/results/longest_wait.h"
#include "api/results/probing.h"
#include "api/services.h"

namespace lpv::api {
namespace {

constexpr std::size_t kMaxQueuedParts = 4;

class ProbeStream final : public StreamOf<ProbeStream, pb::StreamProbeRequest, pb::StreamProbeResponse> {
 public:
  explicit ProbeStream(const Context& context) : context_(context), wait_(context) {}

  void receive(pb::StreamProbeRequest request) override {
    if (hasEnded()) return;
    if (!asked_) {
      if (Status s = ask(request.request()); !s.ok()) return end(s.within("request"));
    }
    Expected<ProbePoints> points = probePoints(request.request().points(), wish_, context_.limits);
    if (!points) return end(points.status().within("request"));
    const MutexLock lock(mutex_);
    if (points->empty()) return;
    waiting_.push_back(std::move(*points));
    startNext();
  }

  void halfClosed() override {
    const MutexLock lock(mutex_);
    inputEnded_ = true;
    if (!asked_) return context_.pool->post([self = me()] { self->end(invalid("request", "no message came")); });
    startNext();
  }

  bool wantsRead() override {
    const MutexLock lock(mutex_);
    return waiting_.size() + answers_.size() < kMaxQueuedParts;
  }

  bool next(pb::StreamProbeResponse* response) override {
    bool finished = false;
    {
      const MutexLock lock(mutex_);
      if (!answers_.empty()) {
        response->mutable_response()->Swap(&answers_.front());
        answers_.pop_front();
        return true;
      }
      finished = inputEnded_ && result_ && waiting_.empty() && !working_;
    }
    if (finished) endInNext(Status());
    return false;
  }

  void release() override {
    wait_.stop();
    if (call_) session_->delivery().forget(call_);
  }

 private:
  Status ask(const pb::ProbeRequest& request) {
    const Expected<SessionPtr> session = findSession(context_, "session", request.session());
    if (!session) return session.status();
    session_ = *session;
    asked_ = true;
    wish_ = ProbeWish::of(request);
    WaitingCall call;
    call.volume = VolumeStage::kTransported;
    call.probed = !wish_.volumeOnly;
    call.minRevision = request.has_min_revision() ? request.min_revision() : session_->revision();
    wait_.start(whileAlive([](ProbeStream& self, const Status& why) { self.end(why); }));
    call.done = whileAlive([](ProbeStream& self, Expected<Result> result) {
      self.wait_.stop();
      if (!result) return self.end(result.status());
      {
        const MutexLock lock(self.mutex_);
        self.result_ = *result;
        self.startNext();
      }
      self.wake();
    });
    call_ = session_->delivery().ask(std::move(call));
    return {};
  }

  /// Answers the next part on a worker, one at a time so that the order stays.
  void startNext() LPV_REQUIRES(mutex_) {
    if (working_ || !result_ || waiting_.empty()) return;
    working_ = true;
    context_.pool->post([self = me(), points = std::move(waiting_.front()), result = *result_, wish = wish_] {
      pb::ProbeResponse answer;
      answerPoints(result, points, wish, &answer);
      {
        const MutexLock lock(self->mutex_);
        self->answers_.push_back(std::move(answer));
        self->working_ = false;
        self->startNext();
      }
      self->wake();
    });
    waiting_.pop_front();
  }

  const Context context_;
  LongestWait wait_;
  SessionPtr session_;
  bool asked_ = false;
  ProbeWish wish_;
  std::shared_ptr<WaitingCall> call_;
  Mutex mutex_;
  std::optional<Result> result_ LPV_GUARDED_BY(mutex_);
  std::deque<ProbePoints> waiting_ LPV_GUARDED_BY(mutex_);
  std::deque<pb::ProbeResponse> answers_ LPV_GUARDED_BY(mutex_);
  bool working_ LPV_GUARDED_BY(mutex_) = false;
  bool inputEnded_ LPV_GUARDED_BY(mutex_) = false;
};

}  // namespace

StreamPtr<pb::StreamProbeRequest, pb::StreamProbeResponse> streamProbe(const Context& context) {
  return std::make_shared<ProbeStream>(context);
}

}  // namespace lpv::api
