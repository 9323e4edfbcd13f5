#include "session/counters.h"

#include <algorithm>

namespace lpv {
namespace {

std::array<std::string, kReasonCount> reasonLabels() {
  std::array<std::string, kReasonCount> out;
  std::copy(kCodeLabels.begin(), kCodeLabels.end(), out.begin());
  auto* label = out.begin() + kCodeLabels.size();
  for (const ReasonName& row : kReasonNames) {
    for (const char c : row.name) label->push_back(c == '_' ? c : char(c - 'A' + 'a'));
    ++label;
  }
  return out;
}

}  // namespace

const std::array<std::string, kReasonCount> kReasons = reasonLabels();

void DurationHistogram::observe(double seconds) {
  const auto bucket = std::lower_bound(kBounds.begin(), kBounds.end(), seconds) - kBounds.begin();
  ++counts_[std::size_t(bucket)];
  sum_ += seconds;
}

std::size_t reasonOf(const Status& status) {
  for (std::size_t i = 0; i < kReasonNames.size(); ++i) {
    if (kReasonNames[i].reason == status.reason()) return kCodeLabels.size() + i;
  }
  return std::size_t(status.code());
}

std::int64_t ReasonCounter::total() const {
  std::int64_t sum = 0;
  for (const auto& count : counts_) sum += count;
  return sum;
}

void TickWatch::begun(Clock::time_point now) {
  if (underWay_ == 0) lastEvent_ = now;
  ++underWay_;
}

void TickWatch::ended(Clock::time_point now, const Status& status) {
  lastEvent_ = now;
  --underWay_;
  if (status.code() == Code::kCancelled) return;
  if (status.ok()) {
    failedInARow_ = 0;
    contextLost_ = false;
    return;
  }
  ++failedInARow_;
  failures_.add(status);
  if (status.code() == Code::kUnavailable) contextLost_ = true;
  const MutexLock lock(mutex_);
  lastFailure_ = status.message();
}

std::chrono::seconds TickWatch::stalledFor(Clock::time_point now) const {
  if (underWay_ == 0) return std::chrono::seconds(0);
  return std::chrono::duration_cast<std::chrono::seconds>(now - lastEvent_.load());
}

std::string TickWatch::lastFailure() const {
  const MutexLock lock(mutex_);
  return lastFailure_;
}

void Counters::countSent(SentAs as, std::int64_t bytes) {
  Sent& counter = sent[std::size_t(as)];
  ++counter.results;
  counter.bytes += bytes;
}

std::int64_t Counters::resultBytesSent() const {
  std::int64_t sum = 0;
  for (const Sent& each : sent) sum += each.bytes;
  return sum;
}

}  // namespace lpv
