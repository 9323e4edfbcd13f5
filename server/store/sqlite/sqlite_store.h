#pragma once
// A store in one SQLite database: DIR/sessions.db with its write-ahead log, DIR/lock. Durability DISK.
//
// One thread writes. Everything that was queued while the last commit ran goes into the next transaction (group
// commit): the disk is waited for once, however many wait. A session's log is folded into its snapshot every
// `compactAfter...`; bytes are kept once, whoever needs them, and let go of with their last holder. The file does not
// shrink: its free pages are used again.

#include <deque>
#include <map>
#include <memory>
#include <set>
#include <thread>
#include "base/mutex.h"

#include "store/sqlite/directory_lock.h"
#include "store/sqlite/tables.h"
#include "store/store.h"

namespace lpv::store {

struct SqliteOptions {
  std::string directory;
  std::int64_t compactAfterRecords = 1000;
  std::int64_t compactAfterBytes = 16 * 1024 * 1024;  ///< of records and of the contents that came with them
  std::chrono::milliseconds retry{250};               ///< between attempts while the directory cannot be written
  /// Runs what whenDurable was given, in order; unset: the store's thread does.
  std::function<void(std::function<void()>)> executor;
  /// Called on the store's thread after every attempt at a transaction, compactions apart: how long it took, fsync
  /// included, and whether it was committed.
  std::function<void(std::chrono::duration<double> took, bool committed)> onCommit;
  /// Called on the store's thread when writing begins to fail (why) and when it has caught up (ok).
  std::function<void(const Status&)> onChange;
};

class SqliteStore final : public Store {
 public:
  /// Errors name the directory: in use by another process, a newer schema, damaged, not writable.
  static Expected<std::unique_ptr<SqliteStore>> open(SqliteOptions options);
  /// Writes what was given, unless the directory cannot be written; callbacks that are due then are not called.
  ~SqliteStore() override;

  lpv::v1::Durability durability() const override { return lpv::v1::DURABILITY_DISK; }
  Status writable() const override;
  Position create(const Head& head, MakeFullSnapshot whole) override;
  Position append(const std::string& session, MakeLogRecord step) override;
  Position setEpoch(const std::string& session, std::uint64_t epoch) override;
  Position touch(const std::string& session, std::chrono::system_clock::time_point used) override;
  Position remove(const std::string& session) override;
  Position keepToken(const Token& token) override;
  Position dropToken(const std::string& tokenId) override;
  void whenDurable(Position position, Kept kept) override;
  Status flush() override;
  Expected<std::vector<Head>> heads() override;
  Expected<std::vector<Token>> tokens() override;
  Expected<Loaded> load(const std::string& session, bool withContents) override;
  std::uint64_t highestEpoch() override { return highestEpoch_; }

  std::int64_t queued() const override;
  /// Transactions committed so far, compactions apart.
  std::int64_t commits() const;

 private:
  /// A change; can be made again after a rollback.
  struct Change {
    Position position = 0;
    std::string session;
    std::function<Status(Tables&, LogSize*)> make;
  };

  explicit SqliteStore(SqliteOptions options) : options_(std::move(options)) {}
  Position push(const std::string& session, std::function<Status(Tables&, LogSize*)> make);
  void run();
  Status commit(const std::deque<Change>& group);
  void settle(const Status& status);
  void tell(std::vector<Kept> waiting, const Status& status);
  void compactDue();

  const SqliteOptions options_;
  std::unique_ptr<DirectoryLock> lock_;
  std::unique_ptr<Tables> tables_;  ///< the store's thread's
  Mutex readMutex_;
  std::unique_ptr<Tables> reading_ LPV_GUARDED_BY(readMutex_);
  std::uint64_t highestEpoch_ = 0;  ///< when the store was opened

  mutable Mutex mutex_;
  ConditionVariable wake_;     ///< there is something to write
  ConditionVariable settled_;  ///< a transaction has ended
  std::deque<Change> queue_ LPV_GUARDED_BY(mutex_);
  std::multimap<Position, Kept> waiting_ LPV_GUARDED_BY(mutex_);
  Position given_ LPV_GUARDED_BY(mutex_) = 0;
  Position durablePosition_ LPV_GUARDED_BY(mutex_) = 0;
  Status failure_ LPV_GUARDED_BY(mutex_);
  std::int64_t commits_ LPV_GUARDED_BY(mutex_) = 0;
  bool stopping_ LPV_GUARDED_BY(mutex_) = false;

  // The store's thread's own.
  std::deque<Change> group_;  ///< of the transaction in progress, or of the one that failed
  std::map<std::string, LogSize> logs_;
  std::set<std::string> due_;  ///< sessions whose log is long
  std::thread thread_;
};

}  // namespace lpv::store
