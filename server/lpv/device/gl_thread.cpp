#include "lpv/device/gl_thread.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <new>
#include <ranges>
#include <vector>

#include "gpu/failure.h"

namespace lpv {

namespace {

// Longest piece of GPU work, so that another session's turn comes soon.
constexpr double kHardwarePieceSeconds = 0.005;
constexpr double kSoftwarePieceSeconds = 0.010;
constexpr std::size_t kPiecesAhead = 2;  // of the GPU: one runs, one waits
constexpr std::chrono::microseconds kNap(500);
/// Gives up on a tick after this many context losses; it may be causing them.
constexpr int kMostLosses = 3;

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

Status abandonedStatus() { return {Code::kCancelled, "the tick was given up for what came after it"}; }

std::unique_ptr<Pipeline> newPipeline(bool software) {
  return std::make_unique<Pipeline>(software ? kSoftwarePieceSeconds : kHardwarePieceSeconds);
}

void noteLength(TickReport& report, double seconds, std::optional<Stage> stage) {
  if (seconds <= report.longestPiece) return;
  report.longestPiece = seconds;
  report.longestStage = stage;
}

}  // namespace

void JobQueue::push(Job job) {
  {
    const MutexLock lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  arrived_.notifyOne();
}

void JobQueue::stop() {
  {
    const MutexLock lock(mutex_);
    stopped_ = true;
  }
  arrived_.notifyOne();
}

void JobQueue::take(bool mayWait, std::vector<Job>& jobs) {
  jobs.clear();
  MutexLock lock(mutex_);
  while (mayWait && !stopped_ && jobs_.empty()) arrived_.wait(lock);
  jobs.swap(jobs_);
}

bool JobQueue::stopped() const {
  const MutexLock lock(mutex_);
  return stopped_;
}

GlThread::GlThread(JobQueue& queue, gpu::Context context, std::shared_ptr<CostModel> costs,
                   std::atomic<std::int64_t>& losses)
    : queue_(queue),
      context_(std::move(context)),
      losses_(losses),
      device_(context_->device()),
      software_(context_->device().software),
      costs_(std::move(costs)),
      pipeline_(newPipeline(software_)) {}

void GlThread::run() {
  std::vector<Job> jobs;
  while (!queue_.stopped()) {
    queue_.take(ticks_.empty(), jobs);
    for (Job& job : jobs) std::visit([this](auto& j) { handle(std::move(j)); }, job);
    jobs.clear();  // what they hold is not kept
    recover();
    takeEnded();
    deliverFinished();
    Tick* next = timeline_.underway() < piecesAhead() ? nextReady() : nullptr;
    if (next != nullptr) {
      advance(*next);
    } else if (!ticks_.empty()) {
      waitForGpu();
    }
  }
  for (Tick& tick : ticks_) tick.done(Status(Code::kCancelled, "the lighting engine stops"));
  queue_.take(false, jobs);
  for (Job& job : jobs) {
    if (auto* submit = std::get_if<SubmitJob>(&job))
      submit->done(Status(Code::kCancelled, "the lighting engine stops"));
  }
  ticks_.clear();
}

/// Where the CPU is the GPU, two pieces run beside each other, and each would be charged with the other's time: two
/// only where both are of one tick.
std::size_t GlThread::piecesAhead() const { return software_ && ticks_.size() > 1 ? 1 : kPiecesAhead; }

void GlThread::handle(SubmitJob job) {
  if (underway(job.request.session)) {
    job.done(Status(Code::kFailedPrecondition, "the session already has a tick under way"));
    return;
  }
  if (const Status made = remake(); !made.ok()) return job.done(made);
  fairQueue_.arrive(job.request.session);
  Tick& tick = ticks_.emplace_back();
  tick.request = std::move(job.request);
  tick.done = std::move(job.done);
  tick.piecesBefore = piecesBegun_;
  begin(tick);
}

void GlThread::begin(Tick& tick) {
  std::shared_ptr<SessionState>& session = sessions_[tick.request.session];
  if (session == nullptr) {
    session = std::make_shared<SessionState>();
    session->clock = std::make_shared<StageClock>(costs_);
  }
  session->clock->restart();
  tick.session = session;
  tick.story.emplace(pipeline_->tick(*tick.session, tick.request, tick.result));
}

/// After the context was lost everything is made again from the scenes: the ticks under way begin anew, and sessions
/// that have none find nothing to keep with their next. All that was made in the old context goes while no new one is
/// there, whose objects have the same numbers.
void GlThread::recover() {
  if (!context_ || !context_->lost()) return;
  ++losses_;
  spdlog::error("the graphics context was lost; {} ticks under way begin anew", ticks_.size());
  for (Tick& tick : ticks_) {
    tick.story.reset();
    tick.session.reset();
    tick.result = {};
    tick.storyEnded = false;
    ++tick.losses;
  }
  timeline_ = {};
  sessions_.clear();
  pipeline_.reset();
  context_.reset();
  Status made = remake();
  for (auto tick = ticks_.begin(); tick != ticks_.end();) {
    if (made.ok() && tick->losses < kMostLosses && !tick->abandoned) {
      begin(*tick++);
      continue;
    }
    const bool abandoned = tick->abandoned;
    const TickDone done = std::move(tick->done);
    tick = ticks_.erase(tick);
    if (abandoned) {
      done(abandonedStatus());
      continue;
    }
    done(made.ok() ? Status(Code::kUnavailable, "the graphics device was reset every time this was tried") : made);
  }
}

/// A context where there is none.
Status GlThread::remake() {
  if (context_) return {};
  Expected<gpu::Context> context = gpu::Context::make(device_);
  if (!context) {
    return {Code::kUnavailable, "the graphics context was lost, and there is no other: " + context.status().message()};
  }
  context_.emplace(std::move(*context));
  try {
    pipeline_ = newPipeline(software_);
  } catch (...) {
    context_.reset();
    return currentError();
  }
  return {};
}

void GlThread::handle(const AbandonJob& job) {
  for (Tick& tick : ticks_) {
    if (tick.request.session != job.session || !tick.request.patient || tick.storyEnded) continue;
    tick.story.reset();
    tick.storyEnded = tick.abandoned = true;
  }
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
    fairQueue_.forget(job.session);
  }
}

bool GlThread::underway(SessionKey session) const {
  return std::any_of(ticks_.begin(), ticks_.end(), [&](const Tick& t) { return t.request.session == session; });
}

bool GlThread::ready(const Tick& tick) {
  if (tick.storyEnded) return false;
  const Pause& pause = tick.story->pause();
  return pause.kind != Pause::Kind::kFence || pause.fence == nullptr || pause.fence->signalled();
}

/// Of the ticks that can go on, the one whose session has had the least of the device; patient ones last.
GlThread::Tick* GlThread::nextReady() {
  const auto pressing = [](const Tick& tick) { return ready(tick) && !tick.request.patient; };
  const bool any = std::ranges::any_of(ticks_, pressing);
  auto able = ticks_ | std::views::filter([&](const Tick& tick) { return any ? pressing(tick) : ready(tick); });
  const auto found =
      leastServed(fairQueue_, able.begin(), able.end(), [](const Tick& tick) { return tick.request.session; });
  return found == able.end() ? nullptr : &*found;
}

void GlThread::advance(Tick& tick) {
  const SessionKey session = tick.request.session;
  fairQueue_.begin(session);
  const auto begin = Timeline::Clock::now();
  gpu::chargeTo(tick.session->charged);
  try {
    tick.story->resume();
  } catch (...) {
    if (!context_->lost()) fail(tick, currentError());
    return;  // what a lost context says means nothing: recover() begins the tick anew
  }
  if (!tick.story->done() && tick.story->pause().kind == Pause::Kind::kPiece) {
    queued(tick, begin);
    return;
  }
  // No piece, only work on this thread: others waited for it all the same.
  const double seconds = std::chrono::duration<double>(Timeline::Clock::now() - begin).count();
  fairQueue_.charge(session, seconds);
  noteLength(tick.result.report, seconds, std::nullopt);
  tick.storyEnded = tick.story->done();
}

void GlThread::queued(Tick& tick, Timeline::Clock::time_point begin) {
  const Pause& pause = tick.story->pause();
  const double predicted = pause.units * tick.session->clock->secondsPerUnit(pause.stage);
  TickReport& report = tick.result.report;
  ++piecesBegun_;
  ++report.pieces;
  if (loseAt_ && piecesBegun_ >= *loseAt_) {
    loseAt_.reset();
    context_->abandon();
    return;
  }
  report.largestPrediction = std::max(report.largestPrediction, predicted);
  fairQueue_.charge(tick.request.session, predicted);
  timeline_.add(pause, predicted, begin, tick.session->clock);
}

GlThread::Tick* GlThread::tickOf(const StageClock& clock) {
  const auto found =
      std::find_if(ticks_.begin(), ticks_.end(), [&](const Tick& tick) { return tick.session->clock.get() == &clock; });
  return found == ticks_.end() ? nullptr : &*found;
}

void GlThread::takeEnded() {
  for (const Timeline::Ended& ended : timeline_.poll()) {
    Tick* tick = tickOf(*ended.owner);
    if (tick == nullptr) continue;  // it has failed
    fairQueue_.charge(tick->request.session, ended.seconds - ended.predicted);
    noteLength(tick->result.report, ended.seconds, ended.stage);
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
    if (!tick->storyEnded || timeline_.holds(*tick->session->clock)) {
      ++tick;
      continue;
    }
    if (tick->abandoned) {
      const TickDone done = std::move(tick->done);
      tick = ticks_.erase(tick);
      done(abandonedStatus());
      continue;
    }
    const StageClock& clock = *tick->session->clock;
    tick->result.report.stages.reserve(kStages);
    for (std::size_t i = 0; i < kStages; ++i) {
      if (clock.ran(Stage(i))) tick->result.report.stages.push_back({Stage(i), clock.seconds(Stage(i))});
    }
    tick->result.report.othersPieces = piecesBegun_ - tick->piecesBefore - tick->result.report.pieces;
    const TickDone done = std::move(tick->done);
    TickResult result = std::move(tick->result);
    tick = ticks_.erase(tick);
    done(std::move(result));
  }
  if (forgetLater_.empty()) return;
  const std::vector<ForgetJob> waiting = std::exchange(forgetLater_, {});
  for (const ForgetJob& job : waiting) handle(job);
}

/// Nothing can be queued: nap on a fence instead of spinning.
void GlThread::waitForGpu() const {
  if (timeline_.underway() > 0) {
    timeline_.waitForOldest(kNap);
    return;
  }
  for (const Tick& tick : ticks_) {
    if (tick.storyEnded || tick.story->pause().kind != Pause::Kind::kFence) continue;
    tick.story->pause().fence->wait(kNap);
    return;
  }
}

}  // namespace lpv
