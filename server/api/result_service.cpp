// Single answers: volumes, frames, probes, picks. Each waits for a result at or after its revision.

#include "api/call/method_table.h"
#include "api/call/reader_patience.h"
#include "api/results/longest_wait.h"
#include "api/results/probing.h"
#include "api/results/subscription_stream.h"
#include "api/services.h"
#include "base/text.h"
#include "convert/geometry.h"
#include "scene/raycast.h"

namespace lpv::api {
namespace {

/// Encoding more pixels than these takes so long that other calls would notice.
constexpr std::int64_t kManyPixels = 2'000'000;

/// A call that asks the session for one result and hands it out in parts, which are built on a worker thread.
template <typename Request, typename Response>
class SingleResultStream : public StreamOf<SingleResultStream<Request, Response>, Request, Response> {
 public:
  explicit SingleResultStream(const Context& context)
      : context_(context), wait_(context), patience_(context, "session") {}

  void receive(Request request) override {
    if (asked_) return;
    asked_ = true;
    const Expected<SessionPtr> session = findSession(context_, "session", request.session());
    if (!session) return this->end(session.status());
    session_ = *session;
    Expected<WaitingCall> call = prepare(request);
    if (!call) return this->end(call.status());
    call->minRevision = request.has_min_revision() ? request.min_revision() : session_->revision();
    call->done =
        this->whileAlive([](SingleResultStream& self, Expected<Result> result) { self.finish(std::move(result)); });
    wait_.start(this->whileAlive([](SingleResultStream& self, const Status& why) { self.end(why); }));
    const std::shared_ptr<WaitingCall> waiting = session_->delivery().ask(std::move(*call));
    const MutexLock lock(mutex_);
    call_ = waiting;
  }

  bool next(Response* response) override {
    bool more = false;
    {
      const MutexLock lock(mutex_);
      if (!parts_) return false;
      more = parts_(response);
      if (!more) parts_ = nullptr;
    }
    if (more) {
      expectReader();
    } else {
      patience_.stop();
      this->endInNext(Status());
    }
    return more;
  }

  void release() override {
    wait_.stop();
    patience_.stop();
    std::shared_ptr<WaitingCall> call;
    Parts dropped;
    {
      const MutexLock lock(mutex_);
      call = call_;
      std::swap(dropped, parts_);
    }
    if (call) session_->delivery().forget(call);
  }

 protected:
  using Parts = std::function<bool(Response*)>;
  /// Checks the request and says what to ask for.
  virtual Expected<WaitingCall> prepare(Request& request) = 0;
  /// The answer's messages. What the result holds is let go of when they are made.
  virtual Expected<Parts> parts(Result result) = 0;
  /// Making them takes long.
  virtual bool takesLong(const Result&) const { return false; }

  const Context context_;
  SessionPtr session_;

 private:
  void finish(Expected<Result> result) {
    wait_.stop();
    if (!result) return this->end(result.status());
    if (!context_.background || !takesLong(*result)) return build(std::move(*result));
    context_.background->post(
        [self = this->me(), taken = std::move(*result)]() mutable { self->build(std::move(taken)); });
  }

  void build(Result result) {
    if (this->hasEnded()) return;
    Expected<Parts> made = parts(std::move(result));
    if (!made) return this->end(made.status());
    {
      const MutexLock lock(mutex_);
      parts_ = std::move(*made);
    }
    if (this->hasEnded()) return release();
    expectReader();
    this->wake();
  }

  void expectReader() {
    patience_.expect(this->whileAlive([](SingleResultStream& self, const Status& why) {
      self.release();
      self.end(why);
    }));
  }

  bool asked_ = false;
  LongestWait wait_;
  ReaderPatience patience_;
  Mutex mutex_;
  Parts parts_ LPV_GUARDED_BY(mutex_);
  std::shared_ptr<WaitingCall> call_ LPV_GUARDED_BY(mutex_);
};

class VolumeResultStream final : public SingleResultStream<pb::GetVolumeRequest, pb::GetVolumeResponse> {
 public:
  using SingleResultStream::SingleResultStream;

 protected:
  Expected<WaitingCall> prepare(pb::GetVolumeRequest& request) override {
    const Expected<VolumeEncodingRequest> order = encodingRequestFrom(request);
    if (!order) return order.status();
    order_ = *order;
    WaitingCall call;
    call.volume = order_.stage;
    call.guarded = order_.guarded;
    return call;
  }
  Expected<Parts> parts(Result result) override {
    const EncodingRoom room = {*context_.answers, session_->id(), context_.limits};
    const Expected<EncodingPtr> encoding =
        context_.caches->encodings.get(order_.sentOf(result.volume), order_, room, *context_.counters);
    if (!encoding) return encoding.status();
    const auto parts = std::make_shared<VolumeParts>(result, order_, *encoding);
    context_.counters->countSent(sentAs(order_.format), parts->bytes());
    return Parts([parts](pb::GetVolumeResponse* response) { return parts->next(response->mutable_part()); });
  }

 private:
  VolumeEncodingRequest order_;
};

class FrameResultStream final : public SingleResultStream<pb::GetFrameRequest, pb::GetFrameResponse> {
 public:
  using SingleResultStream::SingleResultStream;

 protected:
  Expected<WaitingCall> prepare(pb::GetFrameRequest& request) override {
    Expected<FrameEncodingRequest> order = encodingRequestFrom(request, context_.limits);
    if (!order) return order.status();
    if (Status s = session_->delivery().checkCamera(order->subscription.camera); !s.ok()) return s;
    order_ = *order;
    WaitingCall call;
    call.frame = order_.subscription;
    return call;
  }
  bool takesLong(const Result& result) const override {
    return std::int64_t(result.frame->size.x) * result.frame->size.y > kManyPixels;
  }
  Expected<Parts> parts(Result result) override {
    Expected<std::string> file = encodeFrame(*result.frame, order_.format, result.quality);
    if (!file) return file.status();
    const auto bytes = std::make_shared<const std::string>(std::move(*file));
    const auto parts = std::make_shared<FrameParts>(std::move(result), order_.format, bytes);
    context_.counters->countSent(sentAs(order_.format), parts->bytes());
    return Parts([parts](pb::GetFrameResponse* response) { return parts->next(response->mutable_part()); });
  }

 private:
  FrameEncodingRequest order_;
};

class ProbeResultStream final : public SingleResultStream<pb::ProbeRequest, pb::ProbeResponse> {
 public:
  using SingleResultStream::SingleResultStream;

 protected:
  Expected<WaitingCall> prepare(pb::ProbeRequest& request) override {
    wish_ = ProbeWish::of(request);
    Expected<ProbePoints> points = probePoints(request.points(), wish_, context_.limits);
    if (!points) return points.status();
    points_ = std::move(*points);
    WaitingCall call;
    call.volume = VolumeStage::kTransported;
    call.probed = !wish_.volumeOnly;
    return call;
  }
  Expected<Parts> parts(Result result) override {
    auto response = std::make_shared<pb::ProbeResponse>();
    answerPoints(result, points_, wish_, response.get());
    return Parts([response, done = false](pb::ProbeResponse* out) mutable {
      if (done) return false;
      out->Swap(response.get());
      return done = true;
    });
  }

 private:
  ProbePoints points_;
  ProbeWish wish_;
};

}  // namespace

StreamPtr<pb::GetVolumeRequest, pb::GetVolumeResponse> getVolume(const Context& context) {
  return std::make_shared<VolumeResultStream>(context);
}

StreamPtr<pb::GetFrameRequest, pb::GetFrameResponse> getFrame(const Context& context) {
  return std::make_shared<FrameResultStream>(context);
}

StreamPtr<pb::ProbeRequest, pb::ProbeResponse> probe(const Context& context) {
  return std::make_shared<ProbeResultStream>(context);
}

/// The camera and picture size that a pick is about: a live subscriber's, or given.
static Expected<FrameSettings> pickedFrame(const SessionPtr& session, const pb::PickRequest& request,
                                           const Limits& limits) {
  FrameSettings settings;
  if (!request.subscriber().empty()) {
    const std::shared_ptr<Subscriber> subscriber = session->delivery().findSubscriber(request.subscriber());
    const std::optional<FrameSettings> frame =
        subscriber ? session->delivery().subscriptionOf(subscriber).frame : std::nullopt;
    if (!frame) {
      return Status(Code::kNotFound, "there is no frame subscriber \"" + truncatedUtf8(request.subscriber()) + "\"",
                    "subscriber");
    }
    return *frame;
  }
  const Expected<glm::ivec2> size = frameSize(request.width(), request.height(), limits);
  if (!size) return size.status();
  settings.size = *size;
  if (request.has_camera()) {
    const Expected<Camera> camera = fromProto(request.camera());
    if (!camera) return camera.status().within("camera");
    settings.camera.camera = *camera;
  }
  return settings;
}

Status pick(const Context& context, const pb::PickRequest& request, pb::PickResponse* response) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return session.status();
  const Expected<FrameSettings> frame = pickedFrame(*session, request, context.limits);
  if (!frame) return frame.status();
  const glm::dvec2 size(frame->size);
  if (!(request.x() >= 0.0 && request.x() <= size.x && request.y() >= 0.0 && request.y() <= size.y)) {
    return Status(Code::kOutOfRange,
                  "x, y is " + std::to_string(request.x()) + ", " + std::to_string(request.y()) + ", the picture is " +
                      std::to_string(frame->size.x) + " x " + std::to_string(frame->size.y),
                  "x");
  }
  const Expected<Camera> camera = (*session)->delivery().cameraFor(frame->camera, frame->size);
  if (!camera) return camera.status();
  const ScenePtr scene = (*session)->scene();
  response->set_revision(scene->revision);
  const glm::dvec3 direction = camera->rayDirection(request.x() / size.x, request.y() / size.y, size.x / size.y);
  const std::optional<Hit> hit = raycast(*scene, camera->eye, direction);
  if (!hit) return {};
  response->set_hit(true);
  response->set_object(hit->object);
  response->set_kind(hit->isLight ? pb::OBJECT_KIND_LIGHT : pb::OBJECT_KIND_SURFACE);
  toProto(hit->position, response->mutable_position());
  toProto(hit->normal, response->mutable_normal());
  response->set_distance(hit->distance);
  return {};
}

std::vector<Method> resultMethods() {
  return {
      {"ResultService.WatchVolume", Role::kViewer, "subscription.session", handler(watchVolume)},
      {"ResultService.StreamVolume", Role::kViewer, "subscription.session", handler(streamVolume)},
      {"ResultService.WatchFrames", Role::kViewer, "subscription.session", handler(watchFrames)},
      {"ResultService.StreamFrames", Role::kViewer, "subscription.session", handler(streamFrames)},
      {"ResultService.UpdateSubscription", Role::kViewer, "session", handler(updateSubscription)},
      {"ResultService.GetVolume", Role::kViewer, "session", handler(getVolume)},
      {"ResultService.GetFrame", Role::kViewer, "session", handler(getFrame)},
      {"ResultService.Probe", Role::kViewer, "session", handler(probe)},
      {"ResultService.StreamProbe", Role::kViewer, "request.session", handler(streamProbe)},
      {"ResultService.Pick", Role::kViewer, "session", handler(pick)},
  };
}

}  // namespace lpv::api
