#include "store/sqlite/tables.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "store/envelope.h"
#include "store/fold.h"

namespace lpv::store {
namespace {

/// Marks the file as ours ("LPVs"), see `file` and sqlite3's application_id.
constexpr std::int64_t kApplication = 0x4C505673;

constexpr const char* kSchema[] = {
    "CREATE TABLE sessions (id TEXT PRIMARY KEY, epoch INTEGER NOT NULL, request TEXT NOT NULL, created INTEGER NOT "
    "NULL,"
    " used INTEGER NOT NULL, ttl INTEGER NOT NULL) WITHOUT ROWID",
    "CREATE TABLE snapshots (session TEXT PRIMARY KEY, sealed BLOB NOT NULL)",
    "CREATE TABLE log (number INTEGER PRIMARY KEY AUTOINCREMENT, session TEXT NOT NULL, sealed BLOB NOT NULL)",
    "CREATE INDEX log_of ON log (session, number)",
    "CREATE TABLE contents (hash TEXT PRIMARY KEY, kind INTEGER NOT NULL, bytes BLOB NOT NULL)",
    "CREATE TABLE holds (session TEXT NOT NULL, hash TEXT NOT NULL, PRIMARY KEY (session, hash)) WITHOUT ROWID",
    "CREATE INDEX held ON holds (hash)",
    "CREATE TABLE epochs (highest INTEGER NOT NULL)",
    "INSERT INTO epochs VALUES (0)",
};

/// What came after the first databases of this schema version: a database without them has none of what they hold.
constexpr const char* kAdded[] = {
    "CREATE TABLE IF NOT EXISTS tokens (id TEXT PRIMARY KEY, session TEXT NOT NULL, role INTEGER NOT NULL,"
    " hash TEXT NOT NULL, expires INTEGER NOT NULL) WITHOUT ROWID",
    "CREATE INDEX IF NOT EXISTS tokens_of ON tokens (session)",
};

std::int64_t seconds(std::chrono::system_clock::time_point t) {
  return std::chrono::duration_cast<std::chrono::seconds>(t.time_since_epoch()).count();
}

std::chrono::system_clock::time_point timeOf(std::int64_t s) {
  return std::chrono::system_clock::time_point(std::chrono::seconds(s));
}

Status noSession(const std::string& id) {
  return {Code::kNotFound, "there is no session \"" + id + "\" in the state directory", "session"};
}

Expected<std::int64_t> oneNumber(Statement statement) {
  const Expected<bool> row = statement.step();
  if (!row) return row.status();
  return *row ? statement.integer(0) : std::int64_t(0);
}

}  // namespace

Expected<std::unique_ptr<Tables>> Tables::open(const std::string& path) {
  Expected<std::unique_ptr<Database>> database = Database::open(path);
  if (!database) return database.status();
  std::unique_ptr<Tables> tables(new Tables(std::move(*database)));
  if (Status s = tables->prepare(); !s.ok()) return s;
  return tables;
}

Expected<bool> Tables::madeAt(const std::string& path) {
  std::error_code failed;
  if (!std::filesystem::exists(path, failed) || std::filesystem::file_size(path, failed) == 0) return false;
  const Expected<std::unique_ptr<Database>> database = Database::open(path);
  if (!database) return database.status();
  const Expected<std::int64_t> tables = oneNumber((*database)->query("SELECT count(*) FROM sqlite_master"));
  if (!tables) return tables.status();
  return *tables > 0;
}

Status Tables::prepare() {
  const Expected<std::int64_t> version = oneNumber(database_->query("PRAGMA user_version"));
  if (!version) return version.status();
  const Expected<std::int64_t> application = oneNumber(database_->query("PRAGMA application_id"));
  if (!application) return application.status();
  const Expected<std::int64_t> tables = oneNumber(database_->query("SELECT count(*) FROM sqlite_master"));
  if (!tables) return tables.status();
  const bool isNew = *tables == 0 && *version == 0;
  if (!isNew && *application != kApplication) {
    return {Code::kFailedPrecondition, database_->path() + " is a database of another program; give another directory"};
  }
  if (!isNew) {
    if (Status s = checkVersion(database_->path(), std::uint32_t(*version)); !s.ok()) return s;
  }
  // The write-ahead log is synced by every commit: what was committed is there after a power cut too.
  if (Status s = database_->run("PRAGMA journal_mode = WAL"); !s.ok()) return s;
  if (Status s = database_->run("PRAGMA synchronous = FULL"); !s.ok()) return s;
  if (Status s = database_->run("PRAGMA journal_size_limit = 67108864"); !s.ok()) return s;
  Status status = isNew ? makeSchema() : Status();
  for (const char* sql : kAdded) {
    if (status.ok()) status = database_->run(sql);
  }
  return status;
}

Status Tables::makeSchema() {
  static const std::string application = "PRAGMA application_id = " + std::to_string(kApplication);
  static const std::string version = "PRAGMA user_version = " + std::to_string(kSchemaVersion);
  Status status = begin();
  for (const char* sql : kSchema) {
    if (status.ok()) status = database_->run(sql);
  }
  if (status.ok()) status = database_->run(application.c_str());
  if (status.ok()) status = database_->run(version.c_str());
  if (status.ok()) status = commit();
  if (!status.ok()) rollback();
  return status;
}

Status Tables::create(const SessionHead& head, const pb::Snapshot& snapshot, const std::vector<Content>& contents) {
  Status status =
      database_->run("INSERT INTO sessions VALUES (?, ?, ?, ?, ?, ?)", head.id, std::int64_t(head.epoch),
                     head.requestId, seconds(head.created), seconds(head.lastUsed), std::int64_t(head.ttl.count()));
  const Expected<std::string> sealed = seal("the snapshot of session \"" + head.id + "\"", snapshot);
  if (status.ok()) status = sealed.status();
  if (status.ok()) status = database_->run("INSERT INTO snapshots VALUES (?, ?)", head.id, Bytes{*sealed});
  for (const Content& content : contents) {
    if (status.ok()) status = hold(head.id, content);
  }
  return status.ok() ? raiseEpoch(head.epoch) : status;
}

Status Tables::append(const std::string& session, const MakeLogRecord& make, LogSize* size) {
  Status failed;
  const LogRecord step = make([&](const std::string& hash) {
    const Expected<bool> held = holds(session, hash);
    if (!held && failed.ok()) failed = held.status();
    return held && *held;
  });
  if (!failed.ok()) return failed;
  const Expected<std::string> sealed = seal("a step of session \"" + session + "\"", step.record);
  if (!sealed) return sealed.status();
  size->records += 1;
  size->bytes += std::int64_t(sealed->size());
  for (const Content& content : step.contents) {
    if (Status s = hold(session, content); !s.ok()) return s;
    size->bytes += std::int64_t(content.bytes->size());
  }
  if (step.record.has_settings()) {
    Status s = database_->run("UPDATE sessions SET ttl = ? WHERE id = ?",
                              std::int64_t(step.record.settings().ttl().seconds()), session);
    if (!s.ok()) return s;
  }
  // A step of a session that is gone is nobody's: it must not be found by the next of that name.
  return database_->run(
      "INSERT INTO log (session, sealed) SELECT ?, ? WHERE EXISTS (SELECT 1 FROM sessions WHERE id = ?)", session,
      Bytes{*sealed}, session);
}

Status Tables::setEpoch(const std::string& session, std::uint64_t epoch) {
  Status s = database_->run("UPDATE sessions SET epoch = ? WHERE id = ?", std::int64_t(epoch), session);
  return s.ok() ? raiseEpoch(epoch) : s;
}

Status Tables::raiseEpoch(std::uint64_t epoch) {
  return database_->run("UPDATE epochs SET highest = max(highest, ?)", std::int64_t(epoch));
}

Status Tables::touch(const std::string& session, std::int64_t usedSeconds) {
  return database_->run("UPDATE sessions SET used = ? WHERE id = ?", usedSeconds, session);
}

Status Tables::remove(const std::string& session) {
  Status s = database_->run(
      "DELETE FROM contents WHERE hash IN (SELECT hash FROM holds WHERE session = ?1) AND NOT EXISTS"
      " (SELECT 1 FROM holds WHERE holds.hash = contents.hash AND session <> ?1)",
      session);
  for (const char* sql : {"DELETE FROM holds WHERE session = ?", "DELETE FROM log WHERE session = ?",
                          "DELETE FROM snapshots WHERE session = ?", "DELETE FROM tokens WHERE session = ?",
                          "DELETE FROM sessions WHERE id = ?"}) {
    if (s.ok()) s = database_->run(sql, session);
  }
  return s;
}

Status Tables::keepToken(const AccessToken& token) {
  return database_->run("INSERT INTO tokens SELECT ?, ?, ?, ?, ? WHERE EXISTS (SELECT 1 FROM sessions WHERE id = ?2)",
                        token.id, token.session, std::int64_t(token.role), token.hash, seconds(token.expires));
}

Status Tables::dropToken(const std::string& tokenId) {
  return database_->run("DELETE FROM tokens WHERE id = ?", tokenId);
}

Status Tables::compact(const std::string& session) {
  const Expected<pb::Snapshot> snapshot = folded(session);
  if (!snapshot) return snapshot.status().code() == Code::kNotFound ? Status() : snapshot.status();
  const Expected<std::string> sealed = seal("the snapshot of session \"" + session + "\"", *snapshot);
  if (!sealed) return sealed.status();
  Status s = database_->run("UPDATE snapshots SET sealed = ? WHERE session = ?", Bytes{*sealed}, session);
  if (s.ok()) s = database_->run("DELETE FROM log WHERE session = ?", session);
  const auto needed = contentsOf(*snapshot);
  std::vector<std::string> idle;
  {
    Statement held = database_->query("SELECT hash FROM holds WHERE session = ?", session);
    for (Expected<bool> row = held.step(); row && *row; row = held.step()) {
      if (!needed.contains(held.bytes(0))) idle.push_back(held.bytes(0));
    }
  }
  for (const std::string& hash : idle) {
    if (s.ok()) s = letGo(session, hash);
  }
  return s;
}

Status Tables::hold(const std::string& session, const Content& content) {
  Status s = database_->run("INSERT OR IGNORE INTO contents VALUES (?, ?, ?)", content.hash, std::int64_t(content.kind),
                            Bytes{*content.bytes});
  return s.ok() ? database_->run("INSERT OR IGNORE INTO holds VALUES (?, ?)", session, content.hash) : s;
}

Status Tables::letGo(const std::string& session, const std::string& hash) {
  Status s = database_->run("DELETE FROM holds WHERE session = ? AND hash = ?", session, hash);
  if (!s.ok()) return s;
  return database_->run("DELETE FROM contents WHERE hash = ?1 AND NOT EXISTS (SELECT 1 FROM holds WHERE hash = ?1)",
                        hash);
}

Expected<bool> Tables::holds(const std::string& session, const std::string& hash) {
  return database_->query("SELECT 1 FROM holds WHERE session = ? AND hash = ?", session, hash).step();
}

Expected<pb::Snapshot> Tables::folded(const std::string& session) {
  const std::string what = "session \"" + session + "\" in " + database_->path();
  pb::Snapshot out;
  {
    Statement snapshot = database_->query("SELECT sealed FROM snapshots WHERE session = ?", session);
    const Expected<bool> row = snapshot.step();
    if (!row) return row.status();
    if (!*row) return noSession(session);
    if (Status s = unseal("the snapshot of " + what, snapshot.bytes(0), &out); !s.ok()) return s;
  }
  Statement log = database_->query("SELECT sealed FROM log WHERE session = ? ORDER BY number", session);
  while (true) {
    const Expected<bool> row = log.step();
    if (!row) return row.status();
    if (!*row) return out;
    pb::Record record;
    if (Status s = unseal("the log of " + what, log.bytes(0), &record); !s.ok()) return s;
    if (Status s = fold(record, &out); !s.ok()) return Status(s.code(), what + ": " + s.message());
  }
}

Expected<std::vector<SessionHead>> Tables::heads() {
  std::vector<SessionHead> out;
  Statement rows = database_->query("SELECT id, epoch, request, created, used, ttl FROM sessions ORDER BY id");
  while (true) {
    const Expected<bool> row = rows.step();
    if (!row) return row.status();
    if (!*row) return out;
    out.push_back({rows.bytes(0), std::uint64_t(rows.integer(1)), rows.bytes(2), timeOf(rows.integer(3)),
                   timeOf(rows.integer(4)), std::chrono::seconds(rows.integer(5))});
  }
}

Expected<std::vector<AccessToken>> Tables::tokens() {
  std::vector<AccessToken> out;
  Statement rows = database_->query("SELECT id, session, role, hash, expires FROM tokens ORDER BY id");
  while (true) {
    const Expected<bool> row = rows.step();
    if (!row) return row.status();
    if (!*row) return out;
    const std::int64_t role = rows.integer(2);
    if (role < std::int64_t(Role::kViewer) || role > std::int64_t(Role::kOwner)) {
      return Status(Code::kDataLoss, "the state directory has a token of an unknown role: " + rows.bytes(0));
    }
    out.push_back({rows.bytes(0), rows.bytes(1), Role(role), rows.bytes(3), timeOf(rows.integer(4))});
  }
}

Expected<Loaded> Tables::load(const std::string& session, bool withContents) {
  const Expected<std::vector<SessionHead>> all = heads();
  if (!all) return all.status();
  const auto head = std::find_if(all->begin(), all->end(), [&](const SessionHead& each) { return each.id == session; });
  if (head == all->end()) return noSession(session);
  Expected<pb::Snapshot> snapshot = folded(session);
  if (!snapshot) return snapshot.status();
  Loaded out{*head, std::move(*snapshot), {}};
  if (!withContents) return out;
  for (const auto& [hash, kind] : contentsOf(out.snapshot)) {
    Statement content = database_->query("SELECT bytes FROM contents WHERE hash = ?", hash);
    const Expected<bool> row = content.step();
    if (!row) return row.status();
    if (!*row) {
      return Status(Code::kDataLoss, "session \"" + session + "\" in " + database_->path() + " needs the content " +
                                         hash + ", which is missing; restore it from a backup");
    }
    out.contents.push_back({hash, kind, std::make_shared<const std::string>(content.bytes(0))});
  }
  return out;
}

Expected<std::map<std::string, LogSize>> Tables::logSizes() {
  std::map<std::string, LogSize> out;
  Statement rows = database_->query("SELECT session, count(*), sum(length(sealed)) FROM log GROUP BY session");
  while (true) {
    const Expected<bool> row = rows.step();
    if (!row) return row.status();
    if (!*row) return out;
    out[rows.bytes(0)] = {rows.integer(1), rows.integer(2)};
  }
}

Expected<std::int64_t> Tables::highestEpoch() { return oneNumber(database_->query("SELECT highest FROM epochs")); }

}  // namespace lpv::store
