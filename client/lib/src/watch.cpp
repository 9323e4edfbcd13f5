#include "lpv/watch.h"

#include <utility>

#include "lpv/convert.h"
#include "result_stream.h"

namespace lpv::client {
namespace {

struct Volumes {
  using Subscription = v1::VolumeSubscription;
  using Request = v1::StreamVolumeRequest;
  using Response = v1::StreamVolumeResponse;
  using Assembler = VolumeAssembler;
  using Result = VolumeResult;
  static constexpr bool kHasBases = true;
  static auto open(Connection& connection, grpc::ClientContext& context) {
    return connection.results->StreamVolume(&context);
  }
  static std::uint64_t bytes(const Result& result) { return result.bytes; }
};

struct Frames {
  using Subscription = v1::FrameSubscription;
  using Request = v1::StreamFramesRequest;
  using Response = v1::StreamFramesResponse;
  using Assembler = FrameAssembler;
  using Result = FrameResult;
  static constexpr bool kHasBases = false;
  static auto open(Connection& connection, grpc::ClientContext& context) {
    return connection.results->StreamFrames(&context);
  }
  static std::uint64_t bytes(const Result& result) { return result.file.size(); }
};

}  // namespace

struct VolumeWatcher::State : ResultStream<Volumes> {
  using ResultStream::ResultStream;
};

VolumeWatcher::VolumeWatcher(const Client& client, v1::VolumeSubscription subscription, OnVolume onVolume,
                             WatchHooks hooks)
    : state_(std::make_unique<State>(client, std::move(subscription), std::move(onVolume), std::move(hooks))) {}
VolumeWatcher::~VolumeWatcher() = default;
void VolumeWatcher::stop() { state_->stop(); }
WatchStats VolumeWatcher::stats() const { return state_->stats(); }

struct FrameWatcher::State : ResultStream<Frames> {
  using ResultStream::ResultStream;
};

FrameWatcher::FrameWatcher(const Client& client, v1::FrameSubscription subscription, OnFrame onFrame, WatchHooks hooks)
    : state_(std::make_unique<State>(client, std::move(subscription), std::move(onFrame), std::move(hooks))) {}
FrameWatcher::~FrameWatcher() = default;
void FrameWatcher::stop() { state_->stop(); }
WatchStats FrameWatcher::stats() const { return state_->stats(); }

std::uint64_t FrameWatcher::setCamera(const v1::Camera& camera) {
  std::uint64_t sequence = 0;
  state_->update([&](v1::FrameSubscription& subscription, v1::SubscriberUpdate& update) {
    sequence = subscription.camera().sequence() + 1;
    *subscription.mutable_camera()->mutable_camera() = camera;
    subscription.mutable_camera()->set_sequence(sequence);
    subscription.clear_camera_name();
    *update.mutable_camera() = subscription.camera();
  });
  return sequence;
}

void FrameWatcher::setExposure(const v1::Exposure& exposure) {
  state_->update([&](v1::FrameSubscription& subscription, v1::SubscriberUpdate& update) {
    *subscription.mutable_exposure() = exposure;
    *update.mutable_exposure() = exposure;
  });
}

void FrameWatcher::setSize(int width, int height) {
  state_->update([&](v1::FrameSubscription& subscription, v1::SubscriberUpdate& update) {
    subscription.set_width(width);
    subscription.set_height(height);
    update.set_width(width);
    update.set_height(height);
  });
}

struct SceneWatcher::State {
  State(const Client& client, std::string name, std::uint64_t since, OnEvent handler, WatchHooks given,
        v1::ClientIdentity identity)
      : connection(client.connection()),
        session(sessionName(name)),
        revision(since),
        onEvent(std::move(handler)),
        hooks(std::move(given)),
        member(std::move(identity)),
        loop(connection,
             {[this](grpc::ClientContext& context) { return attempt(context); }, hooks.reopening, hooks.ended}) {
    loop.start();
  }

  grpc::Status attempt(grpc::ClientContext& context) {
    v1::WatchSceneRequest request;
    request.set_session(session);
    if (!member.client_id().empty()) *request.mutable_client() = member;
    request.set_since_revision(revision);
    request.set_since_epoch(epoch);
    const auto stream = connection->scene->WatchScene(&context, request);
    v1::WatchSceneResponse response;
    while (loop.read(*stream, response)) handle(response);
    return stream->Finish();
  }

  void handle(const v1::WatchSceneResponse& response) {
    // A revision counts as seen with its last part; after a break between parts the stream resumes before it.
    if (response.has_snapshot() && !response.snapshot().more()) {
      revision = response.snapshot().revision();
      epoch = response.snapshot().epoch();
    }
    if (response.has_change() && !response.change().more()) {
      revision = response.change().last_revision();
      epoch = response.change().epoch();
    }
    if (response.has_heartbeat()) {
      if (hooks.heartbeat) hooks.heartbeat(response.heartbeat());
    } else if (response.has_notice()) {
      if (hooks.notice) hooks.notice(response.notice());
    } else if (onEvent) {
      onEvent(response);
    }
  }

  std::shared_ptr<Connection> connection;
  std::string session;
  std::uint64_t revision;
  std::uint64_t epoch = 0;  ///< of `revision`; 0 while that is the caller's
  OnEvent onEvent;
  WatchHooks hooks;
  v1::ClientIdentity member;
  ReconnectLoop loop;
};

SceneWatcher::SceneWatcher(const Client& client, std::string session, std::uint64_t sinceRevision, OnEvent onEvent,
                           WatchHooks hooks, v1::ClientIdentity member)
    : state_(std::make_unique<State>(client, std::move(session), sinceRevision, std::move(onEvent), std::move(hooks),
                                     std::move(member))) {}
SceneWatcher::~SceneWatcher() = default;
void SceneWatcher::stop() { state_->loop.stop(); }

}  // namespace lpv::client
