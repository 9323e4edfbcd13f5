#include "store/sqlite/database.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lpv::store {
namespace {

constexpr int kBusyPatienceMs = 5000;
constexpr mode_t kOwnerOnly = 0600;

/// Sessions may be private, whatever the folder lets others see. SQLite gives the files that it makes beside the
/// database the permissions of the database. A file is not opened to look: closing it would drop SQLite's locks.
void keepPrivate(const std::string& path) {
  const int made = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, kOwnerOnly);
  if (made >= 0) ::close(made);
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) (void)::chmod((path + suffix).c_str(), kOwnerOnly);
}

}  // namespace

Statement::~Statement() {
  if (statement_ == nullptr) return;
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

Expected<bool> Statement::step() {
  if (statement_ == nullptr || failure_ != SQLITE_OK) return database_.failure();
  const int result = sqlite3_step(statement_);
  if (result == SQLITE_ROW) return true;
  if (result == SQLITE_DONE) return false;
  return database_.failure();
}

std::string Statement::bytes(int column) const {
  const void* data = sqlite3_column_blob(statement_, column);
  return data == nullptr
             ? std::string()
             : std::string(static_cast<const char*>(data), std::size_t(sqlite3_column_bytes(statement_, column)));
}

void Statement::bind(int index, const std::string& text) {
  if (statement_ == nullptr || failure_ != SQLITE_OK) return;
  failure_ = sqlite3_bind_text64(statement_, index, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
}

void Statement::bind(int index, std::int64_t value) {
  if (statement_ == nullptr || failure_ != SQLITE_OK) return;
  failure_ = sqlite3_bind_int64(statement_, index, value);
}

void Statement::bind(int index, const Bytes& bytes) {
  if (statement_ == nullptr || failure_ != SQLITE_OK) return;
  // The caller's bytes outlive the statement: no second copy of 64 MiB.
  failure_ = sqlite3_bind_blob64(statement_, index, bytes.value.data(), bytes.value.size(), SQLITE_STATIC);
}

Expected<std::unique_ptr<Database>> Database::open(const std::string& path) {
  std::unique_ptr<Database> database(new Database(path));
  keepPrivate(path);
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
  if (sqlite3_open_v2(path.c_str(), &database->handle_, flags, nullptr) != SQLITE_OK) return database->failure();
  sqlite3_busy_timeout(database->handle_, kBusyPatienceMs);
  return database;
}

Database::~Database() {
  for (const auto& [sql, statement] : statements_) sqlite3_finalize(statement);
  sqlite3_close(handle_);
}

sqlite3_stmt* Database::prepared(const char* sql) {
  sqlite3_stmt*& statement = statements_[sql];
  if (statement == nullptr) {
    sqlite3_prepare_v3(handle_, sql, -1, SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
  }
  return statement;
}

Status Database::failure() const {
  const int code = handle_ == nullptr ? SQLITE_NOMEM : sqlite3_extended_errcode(handle_);
  const int primary = code & 0xFF;
  const std::string why = (handle_ == nullptr ? "out of memory" : std::string(sqlite3_errmsg(handle_))) + " (SQLite " +
                          std::to_string(code) + ")";
  if (primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB || primary == SQLITE_FORMAT) {
    return {Code::kDataLoss,
            path_ + " is damaged: " + why + "; restore it from a backup, or start with an empty folder"};
  }
  return {Code::kUnavailable, Reason::kStateUnwritable,
          "the state directory cannot be used, " + path_ + ": " + why +
              "; check its free space and its permissions, then repeat"};
}

}  // namespace lpv::store
