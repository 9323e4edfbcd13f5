#pragma once
// One session: a document, its members, its readers. Every public method is thread-safe, takes the session's lock for
// microseconds and never waits for the GPU.

#include <algorithm>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>
#include "base/mutex.h"

#include "base/timers.h"
#include "base/worker_pool.h"
#include "engine/engine.h"
#include "scene/default_view.h"
#include "session/counters.h"
#include "session/delivery/results.h"
#include "session/document/blobs.h"
#include "session/document/document.h"
#include "session/document/history.h"
#include "session/journal.h"
#include "session/limits.h"
#include "session/members/locks.h"
#include "session/members/members.h"
#include "session/members/presence.h"
#include "session/state.h"

namespace lpv {

class Access;

/// What happens to a session without a call, for logs.
enum class SessionEvent {
  kExpired,    ///< idle, and gone with what it held
  kEvicted,    ///< idle: on disk only
  kRetentionEnded,  ///< put away for longer than it is retained
  kTickFailed,
};

/// What sessions share. Outlives them.
struct SessionServices {
  Limits limits;
  Engine* engine = nullptr;
  WorkerPool* pool = nullptr;
  Timers* timers = nullptr;
  Counters* counters = nullptr;
  MeshHasher hasher;
  Journal* journal = nullptr;
  Access* access = nullptr;  ///< told of sessions that are gone; may be null
  /// Told of incidents with the session's id, and why where a reason is known; may be empty. Any thread.
  std::function<void(SessionEvent, const std::string& session, const std::string& why)> onEvent = nullptr;
};

/// A session that shows frames alone has a volume made for its check this many times less often.
inline constexpr int kUnaskedChecks = 6;

class Session : public std::enable_shared_from_this<Session> {
 public:
  Session(std::string id, SessionKey key, std::uint64_t epoch, const LightingSettings& options, SessionPolicy policy,
          const SessionServices& services);
  /// A session that was, under a new epoch.
  Session(SessionKey key, std::uint64_t epoch, const SavedSession& state, const SessionServices& services);
  ~Session();

  /// Gives the journal the session as it is, once, before anything else is done with it. Answers with its time to live.
  std::chrono::seconds journalCreation(const std::string& requestId);

  const std::string& id() const { return id_; }
  std::uint64_t epoch() const { return epoch_; }
  Limits limits() const;
  /// From now on: what was accepted stays, what is refused is refused by these.
  void setLimits(const Limits& limits);
  /// RESOURCE_EXHAUSTED, max_tick_seconds, where the session as it is costs the device too much.
  Status checkCost() const;
  SessionSummary summary() const;
  std::uint64_t revision() const;

  // Members and edits.
  Expected<ClientIdentity> join(const PresenceUpdate& seenAs = {});
  void leave(const ClientIdentity& client);
  Status verify(const ClientIdentity& client) const;
  /// The whole life of an edit: prepared outside the lock, then applied, recorded, told to readers.
  EditOutcome apply(const ClientIdentity& client, Edit edit);
  /// The outcome of an edit that could not even be read: recorded under its sequence like any other.
  EditOutcome recordRejected(const ClientIdentity& client, std::uint64_t sequence, const Status& why);
  /// Takes back the member's newest step, or makes one again that was taken back (session/document/history.h): an edit
  /// in every other respect. FAILED_PRECONDITION where there is none; INVALID_ARGUMENT for nobody.
  EditOutcome undoRedo(const ClientIdentity& client, std::uint64_t sequence, UndoDirection direction);
  /// Puts what `change` makes of the settings in their place; nobody else changes them meanwhile. `change` is called
  /// under the session's lock.
  Status changeSettings(const std::function<Expected<SessionSettings>(const SessionSettings&)>& change);
  /// Calls `kept` once, when everything that was done to the session so far is kept (any thread, no locks), or with why
  /// that is not known. Nobody is told of a change before.
  void whenDurable(std::function<void(const Status&)> kept) const;
  /// The same for an edit: `told` gets its outcome, or UNAVAILABLE where it may be lost.
  void confirmWhenDurable(EditOutcome outcome, std::function<void(const EditOutcome&)> told) const;
  /// Changes are refused for now.
  bool readOnly() const { return !services_.journal->writable().ok(); }
  Durability durability() const { return services_.journal->durability(); }

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
  /// `client`, where it says so, is there for as long as it watches.
  std::uint64_t watch(std::function<void()> changed, std::function<void(Closing)> closed,
                      const std::string& client = {});
  void unwatch(std::uint64_t watcher);

  // Presence. Watchers are told when it changes.
  Status present(const ClientIdentity& client, const PresenceUpdate& update);
  /// Another number after every change.
  std::uint64_t presenceChanges() const;
  PresenceSnapshot presenceSnapshot() const;
  /// Locks lights and surfaces for the member, for 1 s to kMaxLockTime; 0 releases, all of the member's where none is
  /// named. NOT_FOUND, ABORTED, RESOURCE_EXHAUSTED: none of them is locked.
  Status lockObjects(const ClientIdentity& client, const std::vector<std::string>& names, std::chrono::seconds time);
  /// Those who were not heard of for long are gone, and so are locks whose time is over.
  void dropSilentMembers(Clock::time_point now);

  // Results.
  Expected<std::shared_ptr<Subscriber>> subscribe(const Subscription& subscription,
                                                  const std::shared_ptr<ResultSink>& sink);
  void unsubscribe(const std::shared_ptr<Subscriber>& subscriber);
  std::shared_ptr<Subscriber> findSubscriber(const std::string& id) const;
  /// The subscriber has applied `resultId` and everything before it.
  void acknowledge(const std::shared_ptr<Subscriber>& subscriber, std::uint64_t resultId);
  /// The subscriber has lost what it was sent: it is owed the current result again, whole.
  void resend(const std::shared_ptr<Subscriber>& subscriber);
  /// Replaces a frame subscriber's subscription; an older camera sequence keeps the camera that is there.
  Status updateSubscription(const std::shared_ptr<Subscriber>& subscriber, const FrameSettings& subscription,
                            std::optional<double> maxRate);
  /// A copy of what the subscriber wants now.
  Subscription subscriptionOf(const std::shared_ptr<Subscriber>& subscriber) const;
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
  /// Closes the session where it is expired, so that it can come back from where it is kept; says when it was last
  /// used.
  std::optional<std::chrono::system_clock::time_point> evict(std::chrono::system_clock::time_point now);
  /// When the session was last used, once in a while, where that is later than it said last.
  std::optional<std::chrono::system_clock::time_point> useToKeep(std::chrono::system_clock::time_point now);
  /// Without members: what a copy of the session is made from.
  SavedSession state() const;
  void dropUnusedBlobs();
  /// From now on nothing is accepted and nothing ticks; streams stay, and say nothing of it yet.
  void quiesce(Closing why);
  /// Quiesces the session and ends every stream and call.
  void close(Closing why);

 private:
  /// A tick's request and whose results it will make.
  struct TickPlan {
    TickRequest request;
    std::uint64_t epoch = 0;
    Lookup lookup = Lookup::kSh2;
    std::vector<std::shared_ptr<Subscriber>> prefetchFor;  ///< readers of volumes whose credit is out
    Clock::time_point begun;
    std::vector<std::pair<std::shared_ptr<Subscriber>, std::uint64_t>> frameReaders;  ///< with camera sequence
    std::vector<std::shared_ptr<WaitingCall>> volumeCalls;
    std::vector<std::shared_ptr<WaitingCall>> frameCalls;
    std::map<std::string, std::uint64_t> clientSequences;

    bool prefetchesFor(const Subscriber& subscriber) const {
      return std::any_of(prefetchFor.begin(), prefetchFor.end(),
                         [&](const auto& one) { return one.get() == &subscriber; });
    }
    /// Highest accepted sequence of `client` that the scene contains; 0 for nobody.
    std::uint64_t sequenceOf(const std::string& client) const {
      const auto found = clientSequences.find(client);
      return found == clientSequences.end() ? 0 : found->second;
    }
  };
  struct Watcher {
    std::function<void()> changed;
    std::function<void(Closing)> closed;
    std::string client;
  };
  struct Delivery {
    std::shared_ptr<Subscriber> subscriber;
    Result result;
    enum { kOffer, kPrepare, kOfferPrepared } how = kOffer;
  };
  static constexpr Clock::time_point kNever = Clock::time_point::max();

  void predictCosts() LPV_REQUIRES(mutex_);
  Expected<ClientIdentity> addMember(const PresenceUpdate& seenAs) LPV_EXCLUDES(mutex_);
  EditOutcome applyEdit(const ClientIdentity& client, const Edit& edit) LPV_REQUIRES(mutex_);
  EditOutcome applyUndoRedo(const ClientIdentity& client, std::uint64_t sequence, UndoDirection direction)
      LPV_REQUIRES(mutex_);
  Status lockNamed(const std::string& client, const std::vector<std::string>& names, std::chrono::seconds time)
      LPV_REQUIRES(mutex_);
  bool admit(const ClientIdentity& client, std::uint64_t sequence, EditOutcome* outcome) LPV_REQUIRES(mutex_);
  void forget(const std::string& client) LPV_REQUIRES(mutex_);
  std::set<std::string> connected() const LPV_REQUIRES(mutex_);
  void markActive(const std::string& client) LPV_REQUIRES(mutex_);
  void recordOutcome(const ClientIdentity& client, const EditOutcome& outcome) LPV_REQUIRES(mutex_);
  void journal(JournalStep step) LPV_REQUIRES(mutex_);
  JournalStep nextStep() const LPV_REQUIRES(mutex_);
  bool busy() const LPV_REQUIRES(mutex_);
  Status closedStatus(const char* field) const LPV_REQUIRES(mutex_);
  void tellWatchers() LPV_EXCLUDES(mutex_);
  void countAndTell(const EditOutcome& outcome) LPV_EXCLUDES(mutex_);

  // Cameras (session_views.cpp).
  std::optional<Camera> chosenCamera(const CameraChoice& choice) const LPV_REQUIRES(mutex_);
  bool hasView(const FrameSettings& subscription, std::uint64_t minRevision) LPV_REQUIRES(mutex_);
  void chooseView() LPV_REQUIRES(mutex_);
  void viewChosen(const ScenePtr& scene, const DefaultView& view);
  FrameRequest frameRequest(const Subscriber& subscriber) const LPV_REQUIRES(mutex_);
  FrameRequest frameRequest(const FrameSettings& subscription, std::uint64_t view) const LPV_REQUIRES(mutex_);

  // Credit (session_subscribers.cpp).
  bool wants(const Subscriber& subscriber) const LPV_REQUIRES(mutex_);
  bool returnCredits(Subscriber& subscriber, std::uint64_t resultId) LPV_REQUIRES(mutex_);
  bool hasCredit(const Subscriber& subscriber) const LPV_REQUIRES(mutex_);
  bool longTrip(const Subscriber& subscriber) const LPV_REQUIRES(mutex_);

  // Planning (session_results.cpp).
  void scheduleTick() LPV_REQUIRES(mutex_);
  void scheduleTickAt(Clock::time_point when) LPV_REQUIRES(mutex_);
  std::optional<TickPlan> planTick(Clock::time_point now) LPV_REQUIRES(mutex_);
  void planSubscribers(TickPlan& plan, Clock::time_point now, Clock::time_point& next) LPV_REQUIRES(mutex_);
  void planCalls(TickPlan& plan) LPV_REQUIRES(mutex_);
  void addVolume(TickRequest& request, VolumeStage stage);
  void tickDone(const TickPlan& plan, Expected<TickResult> result) LPV_EXCLUDES(mutex_);
  std::vector<Delivery> planDeliveries(const TickPlan& plan, TickResult& tick) LPV_REQUIRES(mutex_);
  void planVolumeDeliveries(const TickPlan& plan, ResultMeta meta, VolumeStage stage, const VolumePtr& volume,
                            std::vector<Delivery>* out) LPV_REQUIRES(mutex_);
  void planFrameDeliveries(const TickPlan& plan, ResultMeta meta, const std::vector<FramePtr>& frames,
                           std::vector<Delivery>* out) LPV_REQUIRES(mutex_);
  void fail(const TickPlan& plan, const Status& status);
  void markSent(Subscriber& subscriber, const Result& result, Clock::time_point now) LPV_REQUIRES(mutex_);
  std::optional<Result> cachedVolume(VolumeStage stage, std::uint64_t minRevision) const LPV_REQUIRES(mutex_);
  void deliver(std::vector<Delivery> deliveries);
  void countCoalesced(std::uint64_t revision, Clock::time_point now) LPV_REQUIRES(mutex_);

  // Ahead of credits (session_prefetch.cpp).
  Clock::time_point dueAt(const Subscriber& subscriber) const LPV_REQUIRES(mutex_);
  Clock::time_point prefetchDueAt(const Subscriber& subscriber) const LPV_REQUIRES(mutex_);
  bool canStorePrefetch(const Subscriber& subscriber) const LPV_REQUIRES(mutex_);
  static Result storePrefetch(Subscriber& subscriber, Result result);
  void dropStalePrefetch(Subscriber& subscriber, Clock::time_point now) LPV_REQUIRES(mutex_);
  std::optional<Result> takePrefetch(Subscriber& subscriber) LPV_REQUIRES(mutex_);
  void tickTook(Clock::duration time) LPV_REQUIRES(mutex_);
  void encodingTook(Clock::duration time);

  void checkLater(const ScenePtr& scene, const VolumePtr& volume) LPV_REQUIRES(mutex_);

  const std::string id_;
  const SessionKey key_;
  const std::uint64_t epoch_;
  const SessionServices services_;  ///< with the limits of the beginning
  const std::chrono::system_clock::time_point created_;

  mutable Mutex mutex_;
  Limits limits_ LPV_GUARDED_BY(mutex_);
  SessionPolicy policy_ LPV_GUARDED_BY(mutex_);
  Document document_ LPV_GUARDED_BY(mutex_);
  Blobs blobs_ LPV_GUARDED_BY(mutex_);
  Members members_ LPV_GUARDED_BY(mutex_);
  History history_ LPV_GUARDED_BY(mutex_);
  PresenceTable presence_ LPV_GUARDED_BY(mutex_);
  Locks locks_ LPV_GUARDED_BY(mutex_);
  std::map<std::uint64_t, Watcher> watchers_ LPV_GUARDED_BY(mutex_);
  std::map<std::string, std::shared_ptr<Subscriber>> subscribers_ LPV_GUARDED_BY(mutex_);
  std::list<std::shared_ptr<WaitingCall>> calls_ LPV_GUARDED_BY(mutex_);
  std::map<VolumeStage, Result> latest_ LPV_GUARDED_BY(mutex_);  ///< newest volume of each stage that was read back
  DefaultView view_ LPV_GUARDED_BY(mutex_);  ///< what those see who gave no camera ...
  ScenePtr viewScene_ LPV_GUARDED_BY(mutex_);  ///< ... chosen from this state; null until somebody asks
  bool choosingView_ LPV_GUARDED_BY(mutex_) = false;
  std::uint64_t nextKey_ LPV_GUARDED_BY(mutex_) = 1;
  std::uint64_t nextResult_ LPV_GUARDED_BY(mutex_) = 1;
  bool tickUnderWay_ LPV_GUARDED_BY(mutex_) = false;
  double tickSeconds_ LPV_GUARDED_BY(mutex_) = 0.0;  ///< from a tick's plan to its results, smoothed
  double encodeSeconds_ LPV_GUARDED_BY(mutex_) = 0.0;  ///< of a volume, smoothed
  std::optional<Closing> closed_ LPV_GUARDED_BY(mutex_);  ///< why, once it is
  bool closeTold_ LPV_GUARDED_BY(mutex_) = false;  ///< to streams and calls
  Position lastJournalled_ LPV_GUARDED_BY(mutex_) = 0;  ///< of the last step that was given to the journal
  Clock::time_point nextTick_ LPV_GUARDED_BY(mutex_){};
  Clock::time_point nextCheck_ LPV_GUARDED_BY(mutex_){};  ///< of a volume that is there
  Clock::time_point nextUnaskedCheck_ LPV_GUARDED_BY(mutex_) =
      Clock::now() + kUnaskedChecks * limits_.selfCheck;  ///< of one made for it
  bool checking_ LPV_GUARDED_BY(mutex_) = false;
  std::optional<MeasuredError> measured_ LPV_GUARDED_BY(mutex_);
  std::optional<Clock::time_point> tickScheduledAt_ LPV_GUARDED_BY(mutex_);
  std::chrono::system_clock::time_point lastUsed_ LPV_GUARDED_BY(mutex_);
  std::chrono::system_clock::time_point keptUse_ LPV_GUARDED_BY(mutex_);
};
using SessionPtr = std::shared_ptr<Session>;

}  // namespace lpv
