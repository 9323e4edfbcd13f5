#include "session/answer_room.h"

#include <algorithm>

namespace lpv {
namespace {

constexpr std::chrono::seconds kPause{1};

/// Rounded up.
std::string megabytes(std::int64_t bytes) { return std::to_string((bytes + 999'999) / 1'000'000) + " MB"; }

Status neverFits(std::int64_t bytes, std::int64_t most) {
  return exhausted(Reason::kMaxAnswerBytes, "max_answer_bytes",
                   "max_answer_bytes: this answer holds up to " + megabytes(bytes) +
                       " while it is made and taken, all answers of the server together may hold " + megabytes(most) +
                       "; ask for less (a smaller picture, a coarser format), or raise --max-answer-bytes");
}

Status full(Reason reason, const char* limit, const char* whose, std::int64_t held, std::int64_t bytes,
            std::int64_t most) {
  return exhausted(reason, limit,
                   std::string(limit) + ": answers in progress of " + whose + " hold " + megabytes(held) +
                       ", this one would add up to " + megabytes(bytes) + ", allowed are " + megabytes(most) +
                       "; take the parts of those under way, then ask again")
      .retriedAfter(kPause);
}

}  // namespace

struct AnswerHold::Books {
  Mutex mutex;
  std::int64_t held LPV_GUARDED_BY(mutex) = 0;
  std::int64_t peak LPV_GUARDED_BY(mutex) = 0;
  std::map<std::string, std::int64_t> ofSession LPV_GUARDED_BY(mutex);
};

void AnswerHold::shrinkTo(std::int64_t bytes) {
  const MutexLock lock(books_->mutex);
  const std::int64_t less = std::max<std::int64_t>(bytes_ - bytes, 0);
  bytes_ -= less;
  books_->held -= less;
  const auto mine = books_->ofSession.find(session_);
  if (mine == books_->ofSession.end()) return;
  mine->second -= less;
  if (mine->second == 0) books_->ofSession.erase(mine);
}

AnswerRoom::AnswerRoom() : books_(std::make_shared<AnswerHold::Books>()) {}

Expected<AnswerHoldPtr> AnswerRoom::take(const std::string& session, std::int64_t bytes, const Limits& limits) {
  if (bytes > limits.maxAnswerBytes) return neverFits(bytes, limits.maxAnswerBytes);
  const MutexLock lock(books_->mutex);
  const auto mine = books_->ofSession.find(session);
  const std::int64_t ofSession = mine == books_->ofSession.end() ? 0 : mine->second;
  if (ofSession > 0 && ofSession + bytes > limits.maxAnswerBytesPerSession) {
    return full(Reason::kMaxAnswerBytesPerSession, "max_answer_bytes_per_session", "this session", ofSession, bytes,
                limits.maxAnswerBytesPerSession);
  }
  if (books_->held + bytes > limits.maxAnswerBytes) {
    return full(Reason::kMaxAnswerBytes, "max_answer_bytes", "this server", books_->held, bytes, limits.maxAnswerBytes);
  }
  books_->held += bytes;
  books_->peak = std::max(books_->peak, books_->held);
  books_->ofSession[session] += bytes;
  return AnswerHoldPtr(new AnswerHold(books_, session, bytes));
}

std::int64_t AnswerRoom::held() const {
  const MutexLock lock(books_->mutex);
  return books_->held;
}

std::int64_t AnswerRoom::peak() const {
  const MutexLock lock(books_->mutex);
  return books_->peak;
}

}  // namespace lpv
