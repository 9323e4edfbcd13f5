#include "session/session.h"

#include <utility>

namespace lpv {

Session::Session(std::string id, SessionKey key, std::uint64_t epoch, const LightingSettings& options,
                 SessionPolicy policy, const SessionServices& services)
    : id_(std::move(id)),
      key_(key),
      epoch_(epoch),
      services_(services),
      created_(std::chrono::system_clock::now()),
      limits_(services.limits),
      policy_(std::move(policy)),
      document_(options, services.limits, services.hasher),
      blobs_(services.limits),
      members_(services.limits),
      history_(services.limits),
      presence_(services.limits),
      lastUsed_(created_),
      keptUse_(created_) {
  predictCosts();
}

Session::Session(SessionKey key, std::uint64_t epoch, const SavedSession& state, const SessionServices& services)
    : id_(state.id),
      key_(key),
      epoch_(epoch),
      services_(services),
      created_(state.created),
      limits_(services.limits),
      policy_(state.policy),
      document_(state.document, services.limits, services.hasher),
      blobs_(services.limits),
      members_(services.limits),
      history_(services.limits),
      presence_(services.limits),
      lastUsed_(std::chrono::system_clock::now()) {
  for (const ClientState& client : state.clients) members_.restore(client);
  predictCosts();
  // What was accepted once stays, where limits have become lower since too; new uploads meet them.
  for (const BlobPtr& blob : state.uploads) blobs_.restore(blob, Clock::now());
}

std::chrono::seconds Session::journalCreation(const std::string& requestId) {
  SavedSession now = state();
  now.requestId = requestId;
  const MutexLock lock(mutex_);
  lastJournalled_ = services_.journal->create(now);
  return policy_.ttl;
}

Limits Session::limits() const {
  const MutexLock lock(mutex_);
  return limits_;
}

void Session::setLimits(const Limits& limits) {
  const MutexLock lock(mutex_);
  limits_ = limits;
  document_.setLimits(limits);
  blobs_.setLimits(limits);
  members_.setLimits(limits);
  history_.setLimits(limits);
  presence_.setLimits(limits);
  scheduleTick();
}

Status Session::checkCost() const {
  const MutexLock lock(mutex_);
  return document_.checkCost();
}

void Session::predictCosts() {
  document_.predictWith([engine = services_.engine](const Workload& workload) { return engine->predict(workload); });
}

Session::~Session() { services_.engine->forget(key_); }

SessionSummary Session::summary() const {
  const MutexLock lock(mutex_);
  SessionSummary out;
  out.id = id_;
  out.displayName = policy_.displayName;
  out.options = document_.options();
  out.grid = document_.grid();
  out.revision = document_.revision();
  out.epoch = epoch_;
  out.created = created_;
  out.ttl = policy_.ttl;
  out.lights = document_.lightCount();
  out.surfaces = document_.surfaceCount();
  out.triangles = document_.triangleCount();
  out.clients = members_.count();
  out.subscribers = subscribers_.size();
  out.blobs = blobs_.count();
  out.blobBytes = blobs_.bytes();
  out.lastUsed = lastUsed_;
  out.measured = measured_;
  out.durability = durability();
  return out;
}

std::uint64_t Session::revision() const {
  const MutexLock lock(mutex_);
  return document_.revision();
}

Status Session::verify(const ClientIdentity& client) const {
  const MutexLock lock(mutex_);
  return members_.verify(client);
}

Status Session::closedStatus(const char* field) const {
  if (closed_ == Closing::kDraining)
    return {Code::kUnavailable, "draining: this server ends; ask another, or this one again later"};
  if (closed_ == Closing::kEvicted) {
    return {Code::kUnavailable, "session \"" + id_ + "\" was idle and is being put away; repeat the call"};
  }
  return {Code::kNotFound, "session \"" + id_ + "\" was deleted", field};
}

Expected<bool> Session::addBlob(const BlobPtr& blob) {
  const MutexLock lock(mutex_);
  if (closed_) return closedStatus("session");
  lastUsed_ = std::chrono::system_clock::now();
  if (Status s = services_.journal->writable(); !s.ok()) return s;
  const Expected<bool> existed = blobs_.add(blob, Clock::now());
  if (!existed || *existed) return existed;
  JournalStep step = nextStep();
  step.upload = blob;
  journal(std::move(step));
  return existed;
}

BlobPtr Session::findBlob(const BlobHash& hash) {
  const MutexLock lock(mutex_);
  blobs_.touch(hash, Clock::now());
  return blobs_.find(hash);
}

MeshPtr Session::findMeshInUse(const BlobHash& hash) const {
  const MutexLock lock(mutex_);
  return document_.meshInUse(hash);
}

ScenePtr Session::scene() {
  const MutexLock lock(mutex_);
  return document_.snapshot();
}

Changes Session::changesSince(std::optional<std::uint64_t> since,
                              std::map<std::string, std::uint64_t>* clientSequences) const {
  const MutexLock lock(mutex_);
  if (clientSequences) *clientSequences = members_.sequencesSince(since.value_or(0));
  return document_.changesSince(since);
}

std::vector<Versioned<Light>> Session::lights() const {
  const MutexLock lock(mutex_);
  return document_.lights();
}

std::vector<Versioned<Surface>> Session::surfaces() const {
  const MutexLock lock(mutex_);
  return document_.surfaces();
}

std::vector<std::pair<std::string, Camera>> Session::cameras() const {
  const MutexLock lock(mutex_);
  return document_.cameras();
}

std::uint64_t Session::watch(std::function<void()> changed, std::function<void(Closing)> closed,
                             const std::string& client) {
  const MutexLock lock(mutex_);
  const std::uint64_t key = nextKey_++;
  if (closed_) {
    services_.pool->post([closed = std::move(closed), why = *closed_] { closed(why); });
  } else {
    watchers_[key] = {std::move(changed), std::move(closed), client};
  }
  return key;
}

void Session::unwatch(std::uint64_t watcher) {
  const MutexLock lock(mutex_);
  const auto found = watchers_.find(watcher);
  if (found == watchers_.end()) return;
  markActive(found->second.client);
  watchers_.erase(found);
  lastUsed_ = std::chrono::system_clock::now();
}

void Session::tellWatchers() {
  std::vector<std::function<void()>> calls;
  {
    const MutexLock lock(mutex_);
    for (const auto& [key, watcher] : watchers_) calls.push_back(watcher.changed);
  }
  for (const auto& call : calls) call();
}

void Session::touch() {
  const MutexLock lock(mutex_);
  lastUsed_ = std::chrono::system_clock::now();
}

bool Session::expired(std::chrono::system_clock::time_point now) const {
  const MutexLock lock(mutex_);
  return policy_.ttl.count() > 0 && !busy() && now - lastUsed_ > policy_.ttl;
}

bool Session::busy() const { return !subscribers_.empty() || !watchers_.empty() || !calls_.empty(); }

std::optional<std::chrono::system_clock::time_point> Session::evict(std::chrono::system_clock::time_point now) {
  const MutexLock lock(mutex_);
  if (closed_ || policy_.ttl.count() == 0 || busy() || now - lastUsed_ <= policy_.ttl) return std::nullopt;
  closed_ = Closing::kEvicted;  // nobody is there to be told
  return lastUsed_;
}

std::optional<std::chrono::system_clock::time_point> Session::useToKeep(std::chrono::system_clock::time_point now) {
  constexpr std::chrono::minutes kEvery{1};
  const MutexLock lock(mutex_);
  const std::chrono::system_clock::time_point used = busy() ? now : lastUsed_;
  if (used - keptUse_ < kEvery) return std::nullopt;
  keptUse_ = used;
  return used;
}

SavedSession Session::state() const {
  const MutexLock lock(mutex_);
  SavedSession out;
  out.id = id_;
  out.epoch = epoch_;
  out.created = created_;
  out.policy = policy_;
  out.document = document_.state();
  out.uploads = blobs_.all();
  return out;
}

void Session::dropUnusedBlobs() {
  const MutexLock lock(mutex_);
  if (closed_ || !services_.journal->writable().ok()) return;
  std::set<BlobHash> used = document_.hashesInUse();
  history_.addHashesInUse(used);
  std::vector<BlobHash> dropped = blobs_.dropUnused(used, Clock::now());
  if (dropped.empty()) return;
  JournalStep step = nextStep();
  step.dropped = std::move(dropped);
  journal(std::move(step));
}

void Session::quiesce(Closing why) {
  const MutexLock lock(mutex_);
  if (!closed_) closed_ = why;
}

void Session::close(Closing why) {
  quiesce(why);
  std::vector<std::shared_ptr<ResultSink>> sinks;
  std::map<std::uint64_t, Watcher> watchers;
  std::list<std::shared_ptr<WaitingCall>> calls;
  Status gone;
  {
    const MutexLock lock(mutex_);
    if (std::exchange(closeTold_, true)) return;
    why = *closed_;
    for (const auto& [id, subscriber] : subscribers_) {
      if (auto sink = subscriber->sink.lock()) sinks.push_back(std::move(sink));
    }
    watchers.swap(watchers_);
    calls.swap(calls_);
    gone = closedStatus("session");
  }
  for (const auto& sink : sinks) sink->close(why);
  for (const auto& [key, watcher] : watchers) watcher.closed(why);
  for (const auto& call : calls) {
    if (call->done) call->done(gone);
  }
}

}  // namespace lpv
