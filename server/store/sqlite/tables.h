#pragma once
// The tables of the database and what is done to them. Every method is part of the transaction around it.

#include <memory>
#include <string>

#include "store/backend.h"
#include "store/sqlite/database.h"

namespace lpv::store {

/// Size of a session's log.
struct LogSize {
  std::int64_t records = 0;
  std::int64_t bytes = 0;  ///< of records and of the contents that they brought
};

/// sessions (one row each), snapshots (sealed), log (sealed records in order), contents (bytes by hash, once),
/// holds (which session needs which content), tokens (who may use which session).
class Tables {
 public:
  /// Whether there is a database with tables; makes none.
  static Expected<bool> madeAt(const std::string& path);
  /// Opens or makes the database. FAILED_PRECONDITION for a newer schema, DATA_LOSS for a file that is none.
  static Expected<std::unique_ptr<Tables>> open(const std::string& path);

  Status begin() { return database_->run("BEGIN IMMEDIATE"); }
  Status beginReading() { return database_->run("BEGIN"); }
  Status commit() { return database_->run("COMMIT"); }
  void rollback() { (void)database_->run("ROLLBACK").ok(); }

  Status create(const SessionHead& head, const pb::Snapshot& snapshot, const std::vector<Content>& contents);
  /// Counts what it writes into `size`.
  Status append(const std::string& session, const MakeLogRecord& step, LogSize* size);
  Status setEpoch(const std::string& session, std::uint64_t epoch);
  Status touch(const std::string& session, std::int64_t usedSeconds);
  Status remove(const std::string& session);
  /// Of a session that is there; else nothing is done.
  Status keepToken(const AccessToken& token);
  Status dropToken(const std::string& tokenId);
  /// Folds the log into the snapshot and lets go of contents that nothing needs any more.
  Status compact(const std::string& session);

  Expected<std::vector<SessionHead>> heads();
  Expected<std::vector<AccessToken>> tokens();
  Expected<Loaded> load(const std::string& session, bool withContents);
  Expected<std::map<std::string, LogSize>> logSizes();
  Expected<std::int64_t> highestEpoch();

 private:
  explicit Tables(std::unique_ptr<Database> database) : database_(std::move(database)) {}
  Status prepare();
  Status makeSchema();
  Status raiseEpoch(std::uint64_t epoch);
  Status hold(const std::string& session, const Content& content);
  Status letGo(const std::string& session, const std::string& hash);
  Expected<bool> holds(const std::string& session, const std::string& hash);
  Expected<pb::Snapshot> folded(const std::string& session);

  std::unique_ptr<Database> database_;
};

}  // namespace lpv::store
