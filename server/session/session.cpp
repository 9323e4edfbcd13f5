#include "session/session.h"

#include <utility>

namespace lpv {

Session::Session(std::string id, SessionKey key, std::uint64_t epoch, const LightingSettings& options,
                 SessionPolicy policy, const SessionServices& services)
    : id_(std::move(id)),
      epoch_(epoch),
      key_(key),
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
      keptUse_(created_),
      delivery_(*this, id_, key, epoch, services) {
  predictCosts();
}

Session::Session(SessionKey key, std::uint64_t epoch, const SavedSession& state, const SessionServices& services)
    : id_(state.id),
      epoch_(epoch),
      key_(key),
      services_(services),
      created_(state.created),
      limits_(services.limits),
      policy_(state.policy),
      document_(state.document, services.limits, services.hasher),
      blobs_(services.limits),
      members_(services.limits),
      history_(services.limits),
      presence_(services.limits),
      lastUsed_(std::chrono::system_clock::now()),
      delivery_(*this, id_, key, epoch, services) {
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
  {
    const MutexLock lock(mutex_);
    limits_ = limits;
    document_.setLimits(limits);
    blobs_.setLimits(limits);
    members_.setLimits(limits);
    history_.setLimits(limits);
    presence_.setLimits(limits);
  }
  delivery_.setLimits(limits);
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
  SessionSummary out;
  out.subscribers = delivery_.subscriberCount();
  out.measured = delivery_.measured();
  out.memory = delivery_.memory();
  {
    const MutexLock lock(forecastMutex_);
    if (forecast_) out.forecast = forecast_->forecast;
  }
  const MutexLock lock(mutex_);
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
  out.blobs = blobs_.count();
  out.blobBytes = blobs_.bytes();
  out.lastUsed = lastUsed_;
  out.durability = durability();
  return out;
}

void Session::updateForecast() {
  const ScenePtr now = scene();
  {
    const MutexLock lock(forecastMutex_);
    if (forecast_ && forecast_->revision == now->revision) return;
  }
  LightingSettings asked;
  std::optional<GridCorrection> correction;
  {
    const MutexLock lock(mutex_);
    asked = document_.options();
    correction = document_.correction();
  }
  const Forecast made = forecast(*now, asked, correction);
  const MutexLock lock(forecastMutex_);
  if (!forecast_ || forecast_->revision < now->revision) forecast_ = {now->revision, made};
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
    return {Code::kUnavailable, Reason::kDraining, "draining: this server ends; ask another, or this one again later"};
  if (closed_ == Closing::kEvicted) {
    return {Code::kUnavailable, Reason::kEvicting,
            "session \"" + id_ + "\" was idle and is being evicted; repeat the call"};
  }
  return {Code::kNotFound, Reason::kSessionDeleted, "session \"" + id_ + "\" was deleted", field};
}

Expected<bool> Session::addBlob(const BlobPtr& blob) {
  const MutexLock lock(mutex_);
  if (closed_) return closedStatus("session");
  lastUsed_ = std::chrono::system_clock::now();
  if (Status s = services_.journal->writable(id_); !s.ok()) return s;
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

ScenePtr Session::scene() { return moment().scene; }

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
  const std::uint64_t key = nextWatcher_++;
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
  if (delivery_.busy()) return false;
  const MutexLock lock(mutex_);
  return policy_.ttl.count() > 0 && watchers_.empty() && now - lastUsed_ > policy_.ttl;
}

std::optional<std::chrono::system_clock::time_point> Session::evict(std::chrono::system_clock::time_point now) {
  std::optional<std::chrono::system_clock::time_point> used;
  delivery_.ifIdle([&] {
    const MutexLock lock(mutex_);
    if (closed_ || policy_.ttl.count() == 0 || !watchers_.empty() || now - lastUsed_ <= policy_.ttl) return;
    closed_ = Closing::kEvicted;  // nobody is there to be told
    used = lastUsed_;
  });
  return used;
}

std::optional<std::chrono::system_clock::time_point> Session::useToKeep(std::chrono::system_clock::time_point now) {
  constexpr std::chrono::minutes kEvery{1};
  const bool read = delivery_.busy();
  const MutexLock lock(mutex_);
  const std::chrono::system_clock::time_point used = read || !watchers_.empty() ? now : lastUsed_;
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
  if (closed_ || !services_.journal->writable(id_).ok()) return;
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
  std::map<std::uint64_t, Watcher> watchers;
  Status gone;
  {
    const MutexLock lock(mutex_);
    if (std::exchange(closeTold_, true)) return;
    why = *closed_;
    watchers.swap(watchers_);
    gone = closedStatus("session");
  }
  delivery_.close(why, gone);
  for (const auto& [key, watcher] : watchers) watcher.closed(why);
}

SceneMoment Session::moment() {
  const MutexLock copying(copyMutex_);
  SceneMoment out;
  SceneUpdate update;
  {
    const MutexLock lock(mutex_);
    update = document_.takeUpdate();
    out.lookup = document_.options().lookup;
    out.clientSequences = members_.sequencesSince(0);
  }
  copy_.apply(update);
  out.scene = copy_.scene();
  return out;
}

ScenePtr Session::viewScene() const {
  const MutexLock lock(mutex_);
  return document_.viewScene();
}

std::optional<Camera> Session::camera(const std::string& name) const {
  const MutexLock lock(mutex_);
  return document_.camera(name);
}

Status Session::accepting() const {
  const MutexLock lock(mutex_);
  return closed_ ? closedStatus("session") : Status();
}

void Session::markUsed(const std::string& client) {
  const MutexLock lock(mutex_);
  lastUsed_ = std::chrono::system_clock::now();
  members_.markActive(client, Clock::now());
}

}  // namespace lpv
