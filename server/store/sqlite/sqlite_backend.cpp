#include "store/sqlite/sqlite_backend.h"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

namespace lpv::store {

namespace {

constexpr const char* kDatabase = "sessions.db";

/// What else in the folder says that sessions were kept here, as a list for people; empty where nothing does. A
/// write-ahead log counts only where the database has not even begun: a first start may be killed right behind that.
std::string tracesIn(const std::string& directory, const DirectoryLock& lock) {
  std::error_code failed;
  const std::string database = directory + "/" + kDatabase;
  const bool begun = std::filesystem::exists(database, failed) && std::filesystem::file_size(database, failed) > 0;
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(directory, failed)) {
    const std::string name = entry.path().filename();
    if (!name.starts_with(kDatabase) || name == kDatabase) continue;
    const std::string rest = name.substr(std::string_view(kDatabase).size());
    const bool sqlites = rest == "-wal" || rest == "-shm" || rest == "-journal";
    if (!sqlites || !begun) names.insert(name);
  }
  if (lock.used()) names.insert("lock, which says that " + std::string(kDatabase) + " was made");
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

Status lostDatabase(const std::string& directory, const std::string& traces) {
  return {Code::kDataLoss,
          "--state-dir " + directory + ": " + kDatabase + " is missing or empty, but sessions were kept here (" +
              traces + "); put " + kDatabase +
              " back from a backup, or empty the folder to begin anew without the sessions",
          "state-dir"};
}

}  // namespace

Expected<std::unique_ptr<SqliteBackend>> SqliteBackend::open(SqliteOptions options) {
  std::unique_ptr<SqliteBackend> backend(new SqliteBackend(std::move(options)));
  Expected<std::unique_ptr<DirectoryLock>> lock = DirectoryLock::take(backend->options_.directory);
  if (!lock) return lock.status();
  backend->lock_ = std::move(*lock);
  const std::string& directory = backend->options_.directory;
  const std::string path = directory + "/" + kDatabase;
  if (const std::string traces = tracesIn(directory, *backend->lock_); !traces.empty()) {
    const Expected<bool> there = Tables::madeAt(path);
    if (!there) return there.status();
    if (!*there) return lostDatabase(directory, traces);
  }
  for (std::unique_ptr<Tables>* tables : {&backend->tables_, &backend->reading_}) {
    Expected<std::unique_ptr<Tables>> opened = Tables::open(path);
    if (!opened) return opened.status();
    *tables = std::move(*opened);
  }
  if (Status s = backend->lock_->markUsed(); !s.ok()) return s;
  const Expected<std::map<std::string, LogSize>> logs = backend->tables_->logSizes();
  if (!logs) return logs.status();
  backend->logs_ = *logs;
  const Expected<std::int64_t> epoch = backend->tables_->highestEpoch();
  if (!epoch) return epoch.status();
  backend->highestEpoch_ = std::uint64_t(*epoch);
  return backend;
}

Status SqliteBackend::begin() { return tables_->begin(); }

Status SqliteBackend::commit() {
  if (Status s = tables_->commit(); !s.ok()) return s;
  for (const auto& [session, size] : std::exchange(inGroup_, {})) {
    logs_[session] = size;
    if (size.records >= options_.compactAfterRecords || size.bytes >= options_.compactAfterBytes) due_.insert(session);
  }
  return {};
}

void SqliteBackend::rollback() {
  tables_->rollback();
  inGroup_.clear();
}

LogSize& SqliteBackend::sizeInGroup(const std::string& session) {
  return inGroup_.try_emplace(session, logs_[session]).first->second;
}

Written SqliteBackend::create(const SessionHead& head, const FullSnapshot& whole) {
  return tables_->create(head, whole.snapshot, whole.contents);
}

Written SqliteBackend::append(const std::string& session, const MakeLogRecord& make) {
  return tables_->append(session, make, &sizeInGroup(session));
}

Written SqliteBackend::setEpoch(const std::string& session, std::uint64_t epoch) {
  return tables_->setEpoch(session, epoch);
}

Written SqliteBackend::touch(const std::string& session, std::chrono::system_clock::time_point used) {
  return tables_->touch(session, std::chrono::duration_cast<std::chrono::seconds>(used.time_since_epoch()).count());
}

Written SqliteBackend::remove(const std::string& session) {
  sizeInGroup(session) = {};
  return tables_->remove(session);
}

Written SqliteBackend::keepToken(const AccessToken& token) { return tables_->keepToken(token); }

Written SqliteBackend::dropToken(const std::string& tokenId) { return tables_->dropToken(tokenId); }

/// A log that cannot be folded now stays as it is: nothing is lost, and it is tried again when as much has come to it.
void SqliteBackend::maintain() {
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

Expected<std::vector<SessionHead>> SqliteBackend::heads() {
  const MutexLock lock(readMutex_);
  return reading_->heads();
}

Expected<std::vector<AccessToken>> SqliteBackend::tokens() {
  const MutexLock lock(readMutex_);
  return reading_->tokens();
}

Expected<Loaded> SqliteBackend::load(const std::string& session, bool withContents) {
  const MutexLock lock(readMutex_);
  if (Status s = reading_->beginReading(); !s.ok()) return s;
  Expected<Loaded> out = reading_->load(session, withContents);
  if (Status s = reading_->commit(); !s.ok() && out) return s;
  return out;
}

}  // namespace lpv::store
