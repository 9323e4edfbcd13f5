#pragma once
// One session: a document, its members, its journal and its life. Results are its Delivery's.

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/mutex.h"
#include "session/delivery/delivery.h"
#include "session/document/blobs.h"
#include "session/document/document.h"
#include "session/document/history.h"
#include "session/document/scene_copy.h"
#include "session/members/locks.h"
#include "session/members/members.h"
#include "session/members/presence.h"
#include "session/services.h"
#include "session/state.h"

namespace lpv {

/// Thread-safe. Every function holds the session's lock for microseconds and never waits for the GPU. A session belongs
/// to a shared_ptr: what it starts on other threads comes back only while it lives.
class Session : public std::enable_shared_from_this<Session>, private SceneSource {
 public:
  Session(std::string id, SessionKey key, std::uint64_t epoch, const LightingSettings& options, SessionPolicy policy,
          const SessionServices& services);
  /// Restores a saved session under a new epoch.
  Session(SessionKey key, std::uint64_t epoch, const SavedSession& state, const SessionServices& services);
  ~Session() override;

  const std::string& id() const { return id_; }
  std::uint64_t epoch() const { return epoch_; }
  /// Who waits for results, and what they get.
  Delivery& delivery() { return delivery_; }

  // Limits and settings.
  Limits limits() const;
  /// New limits apply to what comes from now on; what was accepted under earlier ones stays.
  void setLimits(const Limits& limits);
  /// RESOURCE_EXHAUSTED, max_tick_seconds, where the session as it is costs the device too much.
  Status checkCost() const;
  /// Replaces the settings by what `change` returns for the current ones. `change` is called under the session's lock,
  /// so that no other change of settings comes in between.
  Status changeSettings(const std::function<Expected<SessionSettings>(const SessionSettings&)>& change);

  // Members.
  Expected<ClientIdentity> join(const PresenceUpdate& seenAs = {});
  void leave(const ClientIdentity& client);
  Status verify(const ClientIdentity& client) const;
  /// Updates what other members see of this one (cursor, selection, camera). Calls the watchers where it changed.
  Status present(const ClientIdentity& client, const PresenceUpdate& update);
  /// A counter that grows with every change of presence.
  std::uint64_t presenceChanges() const;
  PresenceSnapshot presenceSnapshot() const;
  /// Locks lights and surfaces for the member, for 1 s to kMaxLockTime. 0 releases them, or all of the member's locks
  /// where `names` is empty. All or none: on NOT_FOUND, ABORTED or RESOURCE_EXHAUSTED nothing is locked.
  Status lockObjects(const ClientIdentity& client, const std::vector<std::string>& names, std::chrono::seconds time);
  /// Removes the presence of members that were silent for longer than `presence_idle`, and locks that have expired.
  void dropSilentMembers(Clock::time_point now);

  // Edits.
  /// Prepares the edit outside the lock, applies it as one revision, journals its outcome and notifies readers.
  EditOutcome apply(const ClientIdentity& client, Edit edit);
  /// Records the outcome of an edit that could not be parsed, under its sequence like any other.
  EditOutcome recordRejected(const ClientIdentity& client, std::uint64_t sequence, const Status& why);
  /// Undoes the member's newest step, or redoes the one undone last (session/document/history.h); an edit in every
  /// other respect. FAILED_PRECONDITION where there is no such step, INVALID_ARGUMENT without a member.
  EditOutcome undoRedo(const ClientIdentity& client, std::uint64_t sequence, UndoDirection direction);

  // The journal.
  /// Writes the whole session to the journal, once, before anything else is done with it. Returns its time to live.
  std::chrono::seconds journalCreation(const std::string& requestId);
  /// Calls `done` once (any thread, no locks): with OK when everything that was done to the session so far is durable,
  /// or with why that is not known. Nobody is told of a change before.
  void whenDurable(std::function<void(const Status&)> done) const;
  /// The same for an edit: `done` gets its outcome, or UNAVAILABLE where the edit may be lost.
  void confirmWhenDurable(EditOutcome outcome, std::function<void(const EditOutcome&)> done) const;
  /// True while the journal cannot write: edits are refused until it can.
  bool readOnly() const { return !services_.journal->writable(id_).ok(); }
  Durability durability() const { return services_.journal->durability(); }

  // Blobs.
  Expected<bool> addBlob(const BlobPtr& blob);
  /// Counts as a use of the blob, which keeps it for a while: the caller may name it in an edit soon.
  BlobPtr findBlob(const BlobHash& hash);
  MeshPtr findMeshInUse(const BlobHash& hash) const;
  void dropUnusedBlobs();

  // Reading.
  SessionSummary summary() const;
  /// Makes the forecast of the scene as it is now, for summaries from now on. Takes up to some hundredths of a second
  /// where the scene has changed: holds no lock, but is not for threads that must not wait.
  void updateForecast();
  std::uint64_t revision() const override;
  ScenePtr scene();
  /// As Document::changesSince, with the newest edit sequence of each client that the changes contain.
  Changes changesSince(std::optional<std::uint64_t> since, std::map<std::string, std::uint64_t>* clientSequences) const;
  std::vector<Versioned<Light>> lights() const;
  std::vector<Versioned<Surface>> surfaces() const;
  std::vector<std::pair<std::string, Camera>> cameras() const;
  /// The session without its members, for a copy or a session file.
  SavedSession state() const;
  /// Calls `changed` (any thread, no locks) after every revision, and `closed` once when the session ends.
  /// A member named as `client` counts as present while the watch lasts.
  std::uint64_t watch(std::function<void()> changed, std::function<void(Closing)> closed,
                      const std::string& client = {});
  void unwatch(std::uint64_t watcher);

  // Life.
  void touch();
  bool expired(std::chrono::system_clock::time_point now) const;
  /// Closes the session if it has expired, so that it can be restored from the store; returns when it was last used.
  std::optional<std::chrono::system_clock::time_point> evict(std::chrono::system_clock::time_point now);
  /// The time of the last use if the journal's record of it has become too old; nullopt otherwise.
  std::optional<std::chrono::system_clock::time_point> useToKeep(std::chrono::system_clock::time_point now);
  /// Stops accepting calls and ticking. Streams stay open and are not told yet.
  void quiesce(Closing why);
  /// Quiesces the session and ends every stream and call.
  void close(Closing why);

 private:
  struct Watcher {
    std::function<void()> changed;
    std::function<void(Closing)> closed;
    std::string client;
  };

  // What delivery reads.
  SceneMoment moment() override;
  ScenePtr viewScene() const override;
  std::optional<Camera> camera(const std::string& name) const override;
  Status accepting() const override;
  void markUsed(const std::string& client) override;
  std::weak_ptr<const void> lifetime() const override { return weak_from_this(); }

  Expected<ClientIdentity> addMember(const PresenceUpdate& seenAs) LPV_EXCLUDES(mutex_);
  void removeMember(const std::string& client) LPV_REQUIRES(mutex_);
  void markActive(const std::string& client) LPV_REQUIRES(mutex_);
  std::set<std::string> watching() const LPV_REQUIRES(mutex_);
  Status lockNamed(const std::string& client, const std::vector<std::string>& names, std::chrono::seconds time)
      LPV_REQUIRES(mutex_);

  bool admit(const ClientIdentity& client, std::uint64_t sequence, EditOutcome* outcome) LPV_REQUIRES(mutex_);
  EditOutcome applyEdit(const ClientIdentity& client, const Edit& edit) LPV_REQUIRES(mutex_);
  EditOutcome applyUndoRedo(const ClientIdentity& client, std::uint64_t sequence, UndoDirection direction)
      LPV_REQUIRES(mutex_);
  void recordOutcome(const ClientIdentity& client, const EditOutcome& outcome) LPV_REQUIRES(mutex_);
  void announce(const EditOutcome& outcome) LPV_EXCLUDES(mutex_);
  void tellWatchers() LPV_EXCLUDES(mutex_);

  JournalStep nextStep() const LPV_REQUIRES(mutex_);
  void journal(JournalStep step) LPV_REQUIRES(mutex_);
  Status closedStatus(const char* field) const LPV_REQUIRES(mutex_);
  void predictCosts() LPV_REQUIRES(mutex_);

  /// Of a revision.
  struct RevisionForecast {
    std::uint64_t revision = 0;
    Forecast forecast;
  };

  const std::string id_;
  const std::uint64_t epoch_;
  const SessionKey key_;
  const SessionServices services_;  ///< its limits are those at creation; limits_ are current
  const std::chrono::system_clock::time_point created_;

  mutable Mutex forecastMutex_;  ///< acquired last
  std::optional<RevisionForecast> forecast_ LPV_GUARDED_BY(forecastMutex_);

  Mutex copyMutex_;
  SceneCopy copy_ LPV_GUARDED_BY(copyMutex_);

  mutable Mutex mutex_ LPV_ACQUIRED_AFTER(copyMutex_);  ///< and after the delivery's (README.md)
  Limits limits_ LPV_GUARDED_BY(mutex_);
  SessionPolicy policy_ LPV_GUARDED_BY(mutex_);
  Document document_ LPV_GUARDED_BY(mutex_);
  Blobs blobs_ LPV_GUARDED_BY(mutex_);
  Members members_ LPV_GUARDED_BY(mutex_);
  History history_ LPV_GUARDED_BY(mutex_);
  PresenceTable presence_ LPV_GUARDED_BY(mutex_);
  Locks locks_ LPV_GUARDED_BY(mutex_);
  std::map<std::uint64_t, Watcher> watchers_ LPV_GUARDED_BY(mutex_);
  std::uint64_t nextWatcher_ LPV_GUARDED_BY(mutex_) = 1;
  std::optional<Closing> closed_ LPV_GUARDED_BY(mutex_);  ///< why, once it is
  bool closeTold_ LPV_GUARDED_BY(mutex_) = false;  ///< to streams and calls
  Position lastJournalled_ LPV_GUARDED_BY(mutex_) = 0;  ///< of the last step that was given to the journal
  std::chrono::system_clock::time_point lastUsed_ LPV_GUARDED_BY(mutex_);
  std::chrono::system_clock::time_point keptUse_ LPV_GUARDED_BY(mutex_);

  Delivery delivery_;
};
using SessionPtr = std::shared_ptr<Session>;

}  // namespace lpv
