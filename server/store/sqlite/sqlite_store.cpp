#include "store/sqlite/sqlite_store.h"

#include <spdlog/spdlog.h>

#include <iterator>
#include <utility>

namespace lpv::store {

Expected<std::unique_ptr<SqliteStore>> SqliteStore::open(SqliteOptions options) {
  std::unique_ptr<SqliteStore> store(new SqliteStore(std::move(options)));
  Expected<std::unique_ptr<DirectoryLock>> lock = DirectoryLock::take(store->options_.directory);
  if (!lock) return lock.status();
  store->lock_ = std::move(*lock);
  const std::string path = store->options_.directory + "/sessions.db";
  for (std::unique_ptr<Tables>* tables : {&store->tables_, &store->reading_}) {
    Expected<std::unique_ptr<Tables>> opened = Tables::open(path);
    if (!opened) return opened.status();
    *tables = std::move(*opened);
  }
  const Expected<std::map<std::string, LogSize>> logs = store->tables_->logSizes();
  if (!logs) return logs.status();
  store->logs_ = *logs;
  const Expected<std::int64_t> epoch = store->tables_->highestEpoch();
  if (!epoch) return epoch.status();
  store->highestEpoch_ = std::uint64_t(*epoch);
  store->thread_ = std::thread([raw = store.get()] { raw->run(); });
  return store;
}

SqliteStore::~SqliteStore() {
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
    waiting_.clear();
  }
  wake_.notifyAll();
  if (thread_.joinable()) thread_.join();
}

Status SqliteStore::writable() const {
  const MutexLock lock(mutex_);
  return failure_;
}

std::int64_t SqliteStore::queued() const {
  const MutexLock lock(mutex_);
  return std::int64_t(given_ - durablePosition_);
}

std::int64_t SqliteStore::commits() const {
  const MutexLock lock(mutex_);
  return commits_;
}

Position SqliteStore::push(const std::string& session, std::function<Status(Tables&, LogSize*)> make) {
  Position position = 0;
  {
    const MutexLock lock(mutex_);
    position = ++given_;
    queue_.push_back({position, session, std::move(make)});
  }
  wake_.notifyAll();
  return position;
}

Position SqliteStore::create(const Head& head, MakeFullSnapshot make) {
  return push(head.id, [head, make = std::move(make)](Tables& tables, LogSize*) {
    const FullSnapshot whole = make();
    return tables.create(head, whole.snapshot, whole.contents);
  });
}

Position SqliteStore::append(const std::string& session, MakeLogRecord step) {
  return push(session, [session, step = std::move(step)](Tables& tables, LogSize* size) {
    return tables.append(session, step, size);
  });
}

Position SqliteStore::setEpoch(const std::string& session, std::uint64_t epoch) {
  return push(session, [session, epoch](Tables& tables, LogSize*) { return tables.setEpoch(session, epoch); });
}

Position SqliteStore::touch(const std::string& session, std::chrono::system_clock::time_point used) {
  const std::int64_t at = std::chrono::duration_cast<std::chrono::seconds>(used.time_since_epoch()).count();
  return push(session, [session, at](Tables& tables, LogSize*) { return tables.touch(session, at); });
}

Position SqliteStore::remove(const std::string& session) {
  return push(session, [session](Tables& tables, LogSize* size) {
    *size = {};
    return tables.remove(session);
  });
}

Position SqliteStore::keepToken(const Token& token) {
  return push(token.session, [token](Tables& tables, LogSize*) { return tables.keepToken(token); });
}

Position SqliteStore::dropToken(const std::string& tokenId) {
  return push({}, [tokenId](Tables& tables, LogSize*) { return tables.dropToken(tokenId); });
}

void SqliteStore::whenDurable(Position position, Kept kept) {
  Status status;
  {
    const MutexLock lock(mutex_);
    if (position > durablePosition_) {
      if (failure_.ok()) {
        waiting_.emplace(position, std::move(kept));
        return;
      }
      status = failure_;
    }
  }
  kept(status);
}

void SqliteStore::run() {
  MutexLock lock(mutex_);
  while (true) {
    if (failure_.ok()) {
      while (!stopping_ && queue_.empty()) wake_.wait(lock);
    } else {
      const auto retry = std::chrono::steady_clock::now() + options_.retry;
      while (!stopping_ && wake_.waitUntil(lock, retry)) continue;
      if (stopping_) return;
    }
    std::move(queue_.begin(), queue_.end(), std::back_inserter(group_));
    queue_.clear();
    if (group_.empty()) return;  // stopping
    lock.unlock();
    const auto begun = std::chrono::steady_clock::now();
    const Status status = commit(group_);
    if (options_.onCommit) options_.onCommit(std::chrono::steady_clock::now() - begun, status.ok());
    settle(status);
    if (status.ok()) compactDue();
    lock.lock();
  }
}

Status SqliteStore::commit(const std::deque<Change>& group) {
  Status status = tables_->begin();
  std::map<std::string, LogSize> logs;
  for (const Change& change : group) {
    if (!status.ok()) break;
    const auto [size, isNew] = logs.try_emplace(change.session);
    if (isNew) size->second = logs_[change.session];
    status = change.make(*tables_, &size->second);
  }
  if (status.ok()) status = tables_->commit();
  if (!status.ok()) {
    tables_->rollback();
    return status;
  }
  for (const auto& [session, size] : logs) {
    logs_[session] = size;
    if (size.records >= options_.compactAfterRecords || size.bytes >= options_.compactAfterBytes) due_.insert(session);
  }
  return {};
}

/// Tells those whose changes are kept, or everybody that it is not known.
void SqliteStore::settle(const Status& status) {
  std::vector<Kept> told;
  bool changed = false;
  {
    const MutexLock lock(mutex_);
    changed = failure_.ok() != status.ok();
    failure_ = status;
    if (status.ok()) {
      durablePosition_ = group_.back().position;
      group_.clear();
      ++commits_;
    }
    const auto end = status.ok() ? waiting_.upper_bound(durablePosition_) : waiting_.end();
    for (auto it = waiting_.begin(); it != end; it = waiting_.erase(it)) told.push_back(std::move(it->second));
  }
  settled_.notifyAll();
  if (changed && options_.onChange) options_.onChange(status);
  tell(std::move(told), status);
}

void SqliteStore::tell(std::vector<Kept> waiting, const Status& status) {
  if (waiting.empty()) return;
  auto call = [waiting = std::move(waiting), status] {
    for (const Kept& kept : waiting) kept(status);
  };
  if (options_.executor) {
    options_.executor(std::move(call));
  } else {
    call();
  }
}

/// A log that cannot be folded now stays as it is: nothing is lost, and it is tried again when as much has come to it.
void SqliteStore::compactDue() {
  for (const std::string& session : std::exchange(due_, {})) {
    Status status = tables_->begin();
    if (status.ok()) status = tables_->compact(session);
    if (status.ok()) status = tables_->commit();
    logs_[session] = {};
    if (status.ok()) continue;
    tables_->rollback();
    spdlog::warn("the log of session \"{}\" could not be folded: {}", session, status.message());
  }
}

Status SqliteStore::flush() {
  MutexLock lock(mutex_);
  const Position last = given_;
  while (durablePosition_ < last && failure_.ok()) settled_.wait(lock);
  return durablePosition_ >= last ? Status() : failure_;
}

Expected<std::vector<Head>> SqliteStore::heads() {
  if (Status s = flush(); !s.ok()) return s;
  const MutexLock lock(readMutex_);
  return reading_->heads();
}

Expected<std::vector<Token>> SqliteStore::tokens() {
  if (Status s = flush(); !s.ok()) return s;
  const MutexLock lock(readMutex_);
  return reading_->tokens();
}

Expected<Loaded> SqliteStore::load(const std::string& session, bool withContents) {
  if (Status s = flush(); !s.ok()) return s;
  const MutexLock lock(readMutex_);
  if (Status s = reading_->beginReading(); !s.ok()) return s;
  Expected<Loaded> out = reading_->load(session, withContents);
  if (Status s = reading_->commit(); !s.ok() && out) return s;
  return out;
}

}  // namespace lpv::store
