#pragma once
// One session: a document, its members, its readers. Every public method is thread-safe, takes the session's lock for
// microseconds and never waits for the GPU.

#include <atomic>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lpv/engine.h"
#include "scene/default_view.h"
#include "session/blobs.h"
#include "session/clients.h"
#include "session/document.h"
#include "session/limits.h"
#include "session/results.h"
#include "session/timers.h"
#include "session/worker_pool.h"

namespace lpv {

/// Counters of the whole server, for stats and metrics.
struct Counters {
  std::atomic<std::int64_t> ticks{0};
  std::atomic<std::int64_t> resultsSent{0};
  std::atomic<std::int64_t> resultBytesSent{0};
  std::atomic<std::int64_t> volumesEncoded{0};
  std::atomic<std::int64_t> editsAccepted{0};
  std::atomic<std::int64_t> editsRejected{0};
};

/// What sessions share. Outlives them.
struct Workshop {
  Limits limits;
  Engine* engine = nullptr;
  WorkerPool* pool = nullptr;
  Timers* timers = nullptr;
  Counters* counters = nullptr;
  MeshHasher hasher;
};

/// What selfCheck found last.
struct MeasuredError {
  double error = 0.0;  ///< raw relative L2 of irradiance
  std::uint64_t revision = 0;
};

/// A session in numbers.
struct SessionSummary {
  std::string id;
  std::string displayName;
  SessionOptions options;
  Grid grid;
  std::uint64_t revision = 0;
  std::uint64_t epoch = 0;
  std::chrono::system_clock::time_point created;
  std::chrono::seconds ttl{3600};
  std::size_t lights = 0;
  std::size_t surfaces = 0;
  std::int64_t triangles = 0;
  std::size_t clients = 0;
  std::size_t subscribers = 0;
  std::size_t blobs = 0;
  std::int64_t blobBytes = 0;
  std::chrono::system_clock::time_point lastUsed;
  std::optional<MeasuredError> measured;
};

/// Settings of a session that are not its light transport's.
struct SessionManners {
  std::chrono::seconds ttl{3600};  ///< 0 = never expires
  std::string displayName;
};

/// A session that shows frames alone has a volume made for its check this many times less often.
inline constexpr int kUnaskedChecks = 6;

class Session : public std::enable_shared_from_this<Session> {
 public:
  Session(std::string id, SessionKey key, std::uint64_t epoch, const SessionOptions& options, SessionManners manners,
          const Workshop& workshop);
  ~Session();

  const std::string& id() const { return id_; }
  std::uint64_t epoch() const { return epoch_; }
  const Limits& limits() const { return workshop_.limits; }
  SessionSummary summary() const;
  std::uint64_t revision() const;

  // Members and edits.
  Expected<ClientIdentity> join();
  void leave(const ClientIdentity& client);
  Status verify(const ClientIdentity& client) const;
  /// The whole life of an edit: prepared outside the lock, then applied, recorded, told to readers.
  EditOutcome apply(const ClientIdentity& client, Edit edit);
  /// The outcome of an edit that could not even be read: recorded under its sequence like any other.
  EditOutcome refuse(const ClientIdentity& client, std::uint64_t sequence, const Status& why);
  Status setOptions(const SessionOptions& options, const std::optional<SessionManners>& manners);

  // Blobs.
  Expected<bool> addBlob(const BlobPtr& blob);
  /// Counts as use of the blob: whoever finds it may name it in an edit soon.
  BlobPtr findBlob(const BlobHash& hash);
  MeshPtr findMeshInUse(const BlobHash& hash) const;

  // Reading the scene.
  ScenePtr scene();
  /// As Document::changesSince, with the clients whose edits are in there.
  Changes changesSince(std::optional<std::uint64_t> since, std::map<std::string, std::uint64_t>* clientSequences) const;
  std::vector<Versioned<Light>> lights() const;
  std::vector<Versioned<Surface>> surfaces() const;
  std::vector<std::pair<std::string, Camera>> cameras() const;
  /// Calls `changed` (any thread, no locks) after every revision, and `closed` once when the session ends.
  std::uint64_t watch(std::function<void()> changed, std::function<void(Closing)> closed);
  void unwatch(std::uint64_t watcher);

  // Results.
  Expected<std::shared_ptr<Subscriber>> subscribe(const Wish& wish, const std::shared_ptr<ResultSink>& sink);
  void unsubscribe(const std::shared_ptr<Subscriber>& subscriber);
  std::shared_ptr<Subscriber> findSubscriber(const std::string& id) const;
  /// The subscriber has applied `resultId` and everything before it.
  void acknowledge(const std::shared_ptr<Subscriber>& subscriber, std::uint64_t resultId);
  /// The subscriber has lost what it was sent: it is owed the current result again, whole.
  void resend(const std::shared_ptr<Subscriber>& subscriber);
  /// Replaces a frame subscriber's wish; an older camera sequence keeps the camera that is there.
  Status rewish(const std::shared_ptr<Subscriber>& subscriber, const FrameWish& wish, std::optional<double> maxRate);
  /// A copy of what the subscriber wants now.
  Wish wishOf(const std::shared_ptr<Subscriber>& subscriber) const;
  /// Answers from a result at or after call.minRevision; forget() takes the call back.
  std::shared_ptr<WaitingCall> ask(WaitingCall call);
  void forget(const std::shared_ptr<WaitingCall>& call);
  /// NOT_FOUND for the name of a camera that is not there.
  Status checkCamera(const CameraChoice& choice) const;
  /// The camera that a choice means now, for pictures of that size. NOT_FOUND for an unknown name. May take as long as
  /// a DefaultView takes.
  Expected<Camera> cameraFor(const CameraChoice& choice, const glm::ivec2& size) const;

  // Life.
  void touch();
  bool expired(std::chrono::system_clock::time_point now) const;
  void dropUnusedBlobs();
  /// Ends every stream and call; afterwards nothing is accepted.
  void close(Closing why);

 private:
  /// A tick's request and whose results it will make.
  struct Planned {
    TickRequest request;
    std::uint64_t epoch = 0;
    Lookup lookup = Lookup::kSh2;
    std::vector<std::shared_ptr<Subscriber>> volumeReaders;
    std::vector<std::pair<std::shared_ptr<Subscriber>, std::uint64_t>> frameReaders;  ///< with camera sequence
    std::vector<std::shared_ptr<WaitingCall>> volumeCalls;
    std::vector<std::shared_ptr<WaitingCall>> frameCalls;
    std::map<std::string, std::uint64_t> clientSequences;

    /// Highest accepted sequence of `client` that the scene contains; 0 for nobody.
    std::uint64_t sequenceOf(const std::string& client) const {
      const auto found = clientSequences.find(client);
      return found == clientSequences.end() ? 0 : found->second;
    }
  };
  struct Watcher {
    std::function<void()> changed;
    std::function<void(Closing)> closed;
  };
  struct Delivery {
    std::shared_ptr<Subscriber> subscriber;
    Result result;
  };

  EditOutcome applyLocked(const ClientIdentity& client, const Edit& edit);
  Status closedStatus(const char* field) const;
  void tellWatchers();

  // Cameras (session_views.cpp).
  std::optional<Camera> chosenCamera(const CameraChoice& choice) const;
  bool hasView(const FrameWish& wish, std::uint64_t minRevision);
  void chooseView();
  void viewChosen(const ScenePtr& scene, const DefaultView& view);
  FrameRequest frameRequest(const FrameWish& wish, std::uint64_t view) const;

  // Planning (session_results.cpp).
  void kick();
  bool wants(const Subscriber& subscriber) const;
  bool hasCredit(const Subscriber& subscriber) const;
  void kickLater(Clock::time_point when);
  std::optional<Planned> planTick(Clock::time_point now);
  void planSubscribers(Planned& plan, Clock::time_point now, Clock::time_point& next);
  void planCalls(Planned& plan);
  void addVolume(TickRequest& request, VolumeStage stage);
  void tickDone(const Planned& plan, Expected<TickResult> result);
  std::vector<Delivery> settle(const Planned& plan, TickResult& tick);
  void settleVolume(const Planned& plan, ResultMeta meta, VolumeStage stage, const VolumePtr& volume,
                    std::vector<Delivery>* out);
  void settleFrames(const Planned& plan, ResultMeta meta, const std::vector<FramePtr>& frames,
                    std::vector<Delivery>* out);
  void fail(const Planned& plan, const Status& status);
  void markSent(Subscriber& subscriber, const Result& result, Clock::time_point now);
  std::optional<Result> cachedVolume(VolumeStage stage, std::uint64_t minRevision) const;
  void deliver(std::vector<Delivery> deliveries);
  void checkLater(const ScenePtr& scene, const VolumePtr& volume);

  const std::string id_;
  const SessionKey key_;
  const std::uint64_t epoch_;
  const Workshop workshop_;
  const std::chrono::system_clock::time_point created_;

  mutable std::mutex mutex_;
  SessionManners manners_;
  Document document_;
  Blobs blobs_;
  Clients clients_;
  std::map<std::uint64_t, Watcher> watchers_;
  std::map<std::string, std::shared_ptr<Subscriber>> subscribers_;
  std::list<std::shared_ptr<WaitingCall>> calls_;
  std::map<VolumeStage, Result> latest_;  ///< newest volume of each stage that was read back
  DefaultView view_;  ///< what those see who gave no camera ...
  ScenePtr viewScene_;  ///< ... chosen from this state; null until somebody asks
  bool choosingView_ = false;
  std::uint64_t nextKey_ = 1;
  std::uint64_t nextResult_ = 1;
  bool tickUnderWay_ = false;
  std::optional<Closing> closed_;  ///< why, once it is
  Clock::time_point nextTick_{};
  Clock::time_point nextCheck_{};  ///< of a volume that is there
  Clock::time_point nextUnaskedCheck_ =
      Clock::now() + kUnaskedChecks * workshop_.limits.selfCheck;  ///< of one made for it
  bool checking_ = false;
  std::optional<MeasuredError> measured_;
  std::optional<Clock::time_point> kickAt_;
  std::chrono::system_clock::time_point lastUsed_;
};
using SessionPtr = std::shared_ptr<Session>;

}  // namespace lpv
