#include "unit/session/session_rig.h"

#include <chrono>
#include <future>
#include <thread>

#include "reference/meshes.h"

namespace lpv::test {

BlobHash nameOfContent(const Mesh& mesh) {
  double sum = 0.0;
  for (const glm::vec3& p : mesh.positions) sum = sum * 31.0 + double(p.x) * 7.0 + double(p.y) * 3.0 + double(p.z);
  return std::to_string(mesh.triangles.size()) + ":" + std::to_string(sum);
}

namespace {

MeshReference square() {
  static const MeshPtr mesh = [] {
    Mesh out = *reference::quad();
    out.hash = nameOfContent(out);
    return std::make_shared<const Mesh>(std::move(out));
  }();
  return {mesh->hash, mesh};
}

}  // namespace

Operation createLight(const std::string& name) {
  CreateLight op{name, {}};
  op.fields.mesh = square();
  return op;
}

Operation createSurface(const std::string& name) {
  CreateSurface op{name, {}};
  op.fields.mesh = square();
  return op;
}

Operation setRadiance(const std::string& light, double value) {
  UpdateLight op{light, {}};
  op.fields.radiance = glm::dvec3(value);
  return op;
}

Operation moveLight(const std::string& light, const glm::dvec3& translation) {
  UpdateLight op{light, {}};
  op.fields.transform.translation = translation;
  return op;
}

Edit editOf(std::vector<Operation> operations, std::uint64_t sequence) {
  Edit edit;
  edit.sequence = sequence;
  edit.operations = std::move(operations);
  return edit;
}

void InstantEngine::submit(TickRequest request, TickDone done) {
  if (const auto act = request.patient ? std::exchange(whenSubmitted_, nullptr) : nullptr) act();
  ++ticks_;
  {
    const std::lock_guard lock(mutex_);
    if (!failure_.ok()) return done(failure_);
    if (request.patient) patient_ = request;
    if (request.patient && holds_) {
      held_ = std::move(done);
      return;
    }
  }
  TickResult result;
  result.revision = request.scene->revision;
  if (request.transported) result.transported = std::make_shared<const Volume>();
  if (request.injected) result.injected = std::make_shared<const Volume>();
  for (const FrameRequest& frame : request.frames) {
    if (frame.reduced) ++reducedFrames_;
    result.frames.push_back(std::make_shared<const Frame>());
  }
  done(std::move(result));
}

void InstantEngine::abandon(SessionKey) {
  TickDone done;
  {
    const std::lock_guard lock(mutex_);
    done = std::exchange(held_, nullptr);
  }
  if (!done) return;
  ++abandoned_;
  done(Status(Code::kCancelled, "abandoned"));
}

bool InstantEngine::holdsOne() const {
  const std::lock_guard lock(mutex_);
  return held_ != nullptr;
}

TickRequest InstantEngine::patient() const {
  const std::lock_guard lock(mutex_);
  return patient_;
}

void InstantEngine::failWith(const Status& status) {
  const std::lock_guard lock(mutex_);
  failure_ = status;
}

void Inbox::offer(const Result& result) {
  const std::lock_guard lock(mutex_);
  results_.push_back(result);
}

void Inbox::prepare(const Result& result) {
  const std::lock_guard lock(mutex_);
  prepared_.push_back(result);
}

std::vector<Result> Inbox::prepared() const {
  const std::lock_guard lock(mutex_);
  return prepared_;
}

void Inbox::close(Closing why) {
  const std::lock_guard lock(mutex_);
  closed_ = why;
}

std::size_t Inbox::count() const {
  const std::lock_guard lock(mutex_);
  return results_.size();
}

Result Inbox::last() const {
  const std::lock_guard lock(mutex_);
  return results_.empty() ? Result() : results_.back();
}

std::optional<Closing> Inbox::closed() const {
  const std::lock_guard lock(mutex_);
  return closed_;
}

Limits Rig::quick() {
  Limits limits;
  limits.maxTickRate = limits.maxEditsPerSecond = 1e9;
  limits.maxAnswerBytesPerSession = limits.maxAnswerBytes = 1LL << 40;  // five large frames wait at once
  return limits;
}

Rig::Rig(Limits limits) : services{limits, &engine, &pool, &timers, &counters, nameOfContent, &journal} {}

Rig::~Rig() {
  timers.stop();
  pool.stop();
}

std::shared_ptr<Session> Rig::session(SessionPolicy policy) {
  return std::make_shared<Session>("room", 1, 7, LightingSettings(), std::move(policy), services);
}

void Rig::settle() {
  // A job may post another, that one a third: tick, delivery, next tick. A few rounds more than any chain is long.
  constexpr int kRounds = 10;
  for (int round = 0; round < kRounds; ++round) {
    std::promise<void> reached;
    pool.post([&reached] { reached.set_value(); });
    reached.get_future().wait();
  }
}

bool eventually(const std::function<bool()>& condition) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace lpv::test
