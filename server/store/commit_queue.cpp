#include "store/commit_queue.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace lpv::store {

CommitQueue::CommitQueue(std::unique_ptr<Backend> backend, CommitQueueOptions options)
    : backend_(std::move(backend)), options_(std::move(options)), pause_(options_.retry) {
  thread_ = std::thread([this] { run(); });
}

CommitQueue::~CommitQueue() {
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
    waiting_.clear();
  }
  wake_.notifyAll();
  thread_.join();
}

Status CommitQueue::available() const {
  const MutexLock lock(mutex_);
  return failure_;
}

Status CommitQueue::writable(const std::string& session) const {
  const MutexLock lock(mutex_);
  return failure_.ok() ? fences_.now(session) : failure_;
}

std::int64_t CommitQueue::queued() const {
  const MutexLock lock(mutex_);
  return std::int64_t(given_ - durablePosition_);
}

std::int64_t CommitQueue::commits() const {
  const MutexLock lock(mutex_);
  return commits_;
}

Position CommitQueue::push(const std::string& session, Change change) {
  return take(session, false, std::move(change));
}

Position CommitQueue::takeOver(const std::string& session, Change change) {
  return take(session, true, std::move(change));
}

Position CommitQueue::take(const std::string& session, bool takesOver, Change change) {
  Position position = 0;
  {
    const MutexLock lock(mutex_);
    position = ++given_;
    queue_.push_back({position, session, takesOver, std::move(change)});
  }
  wake_.notifyAll();
  return position;
}

void CommitQueue::whenDurable(const std::string& session, Position position, Told told) {
  Status status;
  {
    const MutexLock lock(mutex_);
    if (position <= durablePosition_) {
      status = fences_.at(session, position);
    } else if (failure_.ok()) {
      waiting_.emplace(position, Waiter{session, std::move(told)});
      return;
    } else {
      status = failure_;
    }
  }
  told(status);
}

Status CommitQueue::flush() {
  MutexLock lock(mutex_);
  const Position last = given_;
  while (durablePosition_ < last && failure_.ok()) settled_.wait(lock);
  return durablePosition_ >= last ? Status() : failure_;
}

Expected<std::vector<SessionHead>> CommitQueue::heads() {
  if (Status s = flush(); !s.ok()) return s;
  return backend_->heads();
}

Expected<std::vector<AccessToken>> CommitQueue::tokens() {
  if (Status s = flush(); !s.ok()) return s;
  return backend_->tokens();
}

Expected<Loaded> CommitQueue::load(const std::string& session, bool withContents) {
  if (Status s = flush(); !s.ok()) return s;
  return backend_->load(session, withContents);
}

void CommitQueue::run() {
  while (nextGroup()) {
    Fences fences;
    const auto begun = std::chrono::steady_clock::now();
    const Status status = commit(&fences);
    if (options_.onCommit) options_.onCommit(std::chrono::steady_clock::now() - begun, status.ok());
    settle(status, std::move(fences));
    if (status.ok()) backend_->maintain();
  }
}

/// Waits for changes, or after a failure for the next attempt. False: nothing more is to be written.
bool CommitQueue::nextGroup() {
  MutexLock lock(mutex_);
  if (failure_.ok()) {
    pause_ = options_.retry;
    while (!stopping_ && queue_.empty()) wake_.wait(lock);
  } else {
    const auto next = std::chrono::steady_clock::now() + pause_;
    while (!stopping_ && wake_.waitUntil(lock, next)) continue;
    if (stopping_) return false;
    pause_ = std::min(pause_ * 2, std::max(options_.retry, options_.retryAtMost));
  }
  std::move(queue_.begin(), queue_.end(), std::back_inserter(group_));
  queue_.clear();
  return !group_.empty();
}

/// Writes the group. `fences` are those that hold once it is committed.
Status CommitQueue::commit(Fences* fences) {
  {
    const MutexLock lock(mutex_);
    *fences = fences_;
  }
  Status status = backend_->begin();
  for (const Entry& entry : group_) {
    if (!status.ok()) break;
    status = make(entry, fences);
  }
  if (status.ok()) status = backend_->commit();
  if (!status.ok()) backend_->rollback();
  return status;
}

Status CommitQueue::make(const Entry& entry, Fences* fences) {
  if (!entry.takesOver && !fences->now(entry.session).ok()) return {};
  const Written written = entry.change(*backend_);
  if (written.isFenced()) {
    fences->add(entry.session, entry.position, written.status());
    return {};
  }
  if (written.status().ok() && entry.takesOver) fences->lift(entry.session, entry.position);
  return written.status();
}

/// Tells those whose changes are kept or fenced, or everybody that it is not known.
void CommitQueue::settle(const Status& status, Fences fences) {
  std::vector<Notice> notices;
  bool changed = false;
  {
    const MutexLock lock(mutex_);
    changed = failure_.ok() != status.ok();
    failure_ = status;
    if (status.ok()) {
      durablePosition_ = group_.back().position;
      fences_ = std::move(fences);
      group_.clear();
      ++commits_;
    }
    const auto end = status.ok() ? waiting_.upper_bound(durablePosition_) : waiting_.end();
    for (auto it = waiting_.begin(); it != end; it = waiting_.erase(it)) {
      auto& [session, told] = it->second;
      notices.push_back({std::move(told), status.ok() ? fences_.at(session, it->first) : status});
    }
  }
  settled_.notifyAll();
  if (changed && options_.onChange) options_.onChange(status);
  tell(std::move(notices));
}

void CommitQueue::tell(std::vector<Notice> notices) {
  if (notices.empty()) return;
  auto call = [notices = std::move(notices)] {
    for (const Notice& notice : notices) notice.told(notice.status);
  };
  if (options_.executor) {
    options_.executor(std::move(call));
  } else {
    call();
  }
}

}  // namespace lpv::store
