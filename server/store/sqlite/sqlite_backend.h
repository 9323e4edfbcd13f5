#pragma once
// The tables in one SQLite database: DIR/sessions.db with its write-ahead log, DIR/lock. Durability DISK.
//
// A session's log is folded into its snapshot every `compactAfter...`; bytes are kept once, whoever needs them, and let
// go of with their last holder. The file does not shrink: its free pages are used again.

#include <map>
#include <memory>
#include <set>
#include <string>

#include "base/mutex.h"
#include "store/backend.h"
#include "store/sqlite/directory_lock.h"
#include "store/sqlite/tables.h"

namespace lpv::store {

struct SqliteOptions {
  std::string directory;
  std::int64_t compactAfterRecords = 1000;
  std::int64_t compactAfterBytes = 16 * 1024 * 1024;  ///< of records and of the contents that came with them
};

class SqliteBackend final : public Backend {
 public:
  /// Errors name the directory: in use by another process, a newer schema, damaged, not writable.
  static Expected<std::unique_ptr<SqliteBackend>> open(SqliteOptions options);

  lpv::v1::Durability durability() const override { return lpv::v1::DURABILITY_DISK; }
  Status begin() override;
  Status commit() override;
  void rollback() override;
  Written create(const SessionHead& head, const FullSnapshot& whole) override;
  Written append(const std::string& session, const MakeLogRecord& make) override;
  Written setEpoch(const std::string& session, std::uint64_t epoch) override;
  Written touch(const std::string& session, std::chrono::system_clock::time_point used) override;
  Written remove(const std::string& session) override;
  Written keepToken(const AccessToken& token) override;
  Written dropToken(const std::string& tokenId) override;
  void maintain() override;
  Expected<std::vector<SessionHead>> heads() override;
  Expected<std::vector<AccessToken>> tokens() override;
  Expected<Loaded> load(const std::string& session, bool withContents) override;
  std::uint64_t highestEpoch() const override { return highestEpoch_; }

 private:
  explicit SqliteBackend(SqliteOptions options) : options_(std::move(options)) {}
  LogSize& sizeInGroup(const std::string& session);

  const SqliteOptions options_;
  std::unique_ptr<DirectoryLock> lock_;
  std::uint64_t highestEpoch_ = 0;

  Mutex readMutex_;
  std::unique_ptr<Tables> reading_ LPV_PT_GUARDED_BY(readMutex_);

  // The writing thread's own.
  std::unique_ptr<Tables> tables_;
  std::map<std::string, LogSize> logs_;  ///< as committed
  std::map<std::string, LogSize> inGroup_;  ///< of the sessions that the group changes, with its changes
  std::set<std::string> due_;  ///< sessions whose log is long
};

}  // namespace lpv::store
