#include "lpv/gl_thread.h"

#include <algorithm>
#include <new>

#include "gpu/failure.h"

namespace lpv {

namespace {

// Longest piece of GPU work, so that another session's turn comes soon.
constexpr double kHardwarePieceSeconds = 0.005;
constexpr double kSoftwarePieceSeconds = 0.010;
/// Pieces queued ahead of the GPU: one runs, one waits.
constexpr std::size_t kPiecesAhead = 2;
constexpr std::chrono::microseconds kNap(500);

/// The error being handled, as a status.
Status currentError() {
  try {
    throw;
  } catch (const gpu::Failure& failure) {
    return failure.status();
  } catch (const std::bad_alloc&) {
    return {Code::kResourceExhausted, "out of memory"};
  } catch (const std::exception& error) {
    return {Code::kInternal, error.what()};
  }
}

}  // namespace

void JobQueue::push(Job job) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  arrived_.notify_one();
}

void JobQueue::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  arrived_.notify_one();
}

std::deque<Job> JobQueue::take(bool mayWait) {
  std::unique_lock lock(mutex_);
  if (mayWait) arrived_.wait(lock, [this] { return stopped_ || !jobs_.empty(); });
  return std::exchange(jobs_, {});
}

bool JobQueue::stopped() const {
  const std::lock_guard lock(mutex_);
  return stopped_;
}

GlThread::GlThread(JobQueue& queue, bool software)
    : queue_(queue), pipeline_(software ? kSoftwarePieceSeconds : kHardwarePieceSeconds) {}

void GlThread::run() {
  while (!queue_.stopped()) {
    for (Job& job : queue_.take(ticks_.empty())) std::visit([this](auto& j) { handle(std::move(j)); }, job);
    timeline_.poll();
    deliverFinished();
    Tick* next = timeline_.underway() < kPiecesAhead ? nextReady() : nullptr;
    if (next != nullptr) {
      advance(*next);
    } else if (!ticks_.empty()) {
      waitForGpu();
    }
  }
  for (Tick& tick : ticks_) tick.done(Status(Code::kCancelled, "the lighting engine stops"));
  for (Job& job : queue_.take(false)) {
    if (auto* submit = std::get_if<SubmitJob>(&job))
      submit->done(Status(Code::kCancelled, "the lighting engine stops"));
  }
  ticks_.clear();
}

void GlThread::handle(SubmitJob job) {
  if (underway(job.request.session)) {
    job.done(Status(Code::kFailedPrecondition, "the session already has a tick under way"));
    return;
  }
  std::shared_ptr<SessionState>& session = sessions_[job.request.session];
  if (session == nullptr) session = std::make_shared<SessionState>();
  session->clock->restart();
  Tick& tick = ticks_.emplace_back();
  tick.request = std::move(job.request);
  tick.done = std::move(job.done);
  tick.session = session;
  tick.story.emplace(pipeline_.tick(*tick.session, tick.request, tick.result));
}

void GlThread::handle(const ForgetJob& job) {
  if (underway(job.session)) {
    forgetLater_.push_back(job);
  } else {
    forgetNow(job);
  }
}

void GlThread::forgetNow(const ForgetJob& job) {
  const auto session = sessions_.find(job.session);
  if (session == sessions_.end()) return;
  if (job.view) {
    session->second->views.erase(*job.view);
  } else {
    sessions_.erase(session);
  }
}

bool GlThread::underway(SessionKey session) const {
  return std::any_of(ticks_.begin(), ticks_.end(), [&](const Tick& t) { return t.request.session == session; });
}

bool GlThread::ready(const Tick& tick) {
  if (tick.told) return false;
  const Pause& pause = tick.story->pause();
  return pause.kind != Pause::Kind::kFence || pause.fence == nullptr || pause.fence->signalled();
}

/// The first tick that can go on; it goes to the end of the line.
GlThread::Tick* GlThread::nextReady() {
  const auto found = std::find_if(ticks_.begin(), ticks_.end(), ready);
  if (found == ticks_.end()) return nullptr;
  ticks_.splice(ticks_.end(), ticks_, found);
  return &ticks_.back();
}

void GlThread::advance(Tick& tick) {
  const auto begin = Timeline::Clock::now();
  try {
    tick.story->resume();
  } catch (...) {
    fail(tick, currentError());
    return;
  }
  if (tick.story->done()) {
    tick.told = true;
  } else if (tick.story->pause().kind == Pause::Kind::kPiece) {
    timeline_.add(tick.story->pause(), begin, tick.session->clock);
  }
}

void GlThread::fail(Tick& tick, const Status& status) {
  gpu::clearErrors();
  tick.session->invalidate();
  const TickDone done = std::move(tick.done);
  ticks_.remove_if([&](const Tick& t) { return &t == &tick; });
  done(status);
}

void GlThread::deliverFinished() {
  for (auto tick = ticks_.begin(); tick != ticks_.end();) {
    if (!tick->told || timeline_.holds(*tick->session->clock)) {
      ++tick;
      continue;
    }
    const StageClock& clock = *tick->session->clock;
    for (std::size_t i = 0; i < kStages; ++i) {
      if (clock.ran(Stage(i))) tick->result.report.stages.push_back({kStageNames[i], clock.seconds(Stage(i))});
    }
    const TickDone done = std::move(tick->done);
    TickResult result = std::move(tick->result);
    tick = ticks_.erase(tick);
    done(std::move(result));
  }
  const std::deque<ForgetJob> waiting = std::exchange(forgetLater_, {});
  for (const ForgetJob& job : waiting) handle(job);
}

/// Nothing can be queued: nap on a fence instead of spinning.
void GlThread::waitForGpu() const {
  if (timeline_.underway() > 0) {
    timeline_.waitForOldest(kNap);
    return;
  }
  for (const Tick& tick : ticks_) {
    if (tick.told || tick.story->pause().kind != Pause::Kind::kFence) continue;
    tick.story->pause().fence->wait(kNap);
    return;
  }
}

}  // namespace lpv
