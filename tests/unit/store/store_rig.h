#pragma once
// A store in a folder of its own, and small sessions to keep in it.

#include <sys/resource.h>

#include <filesystem>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "store/commit_queue.h"
#include "store/sqlite/sqlite_backend.h"

namespace lpv::store {

/// A folder that goes with this.
class Folder {
 public:
  Folder();
  ~Folder();
  const std::string& path() const { return path_; }
  std::string database() const { return path_ + "/sessions.db"; }
  std::uintmax_t logBytes() const { return std::filesystem::file_size(database() + "-wal"); }

 private:
  std::string path_;
};

/// While it lives no file of this process grows beyond `bytes`: writes fail as on a disk with an error.
class FileLimit {
 public:
  explicit FileLimit(std::uintmax_t bytes);
  ~FileLimit();

 private:
  rlimit before_{};
};

/// A queue before SQLite's tables, with a method for each change of a session.
class SqliteStore : public CommitQueue {
 public:
  using CommitQueue::CommitQueue;

  Position create(const SessionHead& head, const FullSnapshot& whole);
  Position append(const std::string& session, MakeLogRecord make);
  Position setEpoch(const std::string& session, std::uint64_t epoch);
  Position touch(const std::string& session, std::chrono::system_clock::time_point used);
  Position remove(const std::string& session);
};

/// Opens, or fails the test.
std::unique_ptr<SqliteStore> openStore(const Folder& folder, SqliteOptions options = {}, CommitQueueOptions queue = {});

/// A session at revision 0 with one member "me".
Position createSession(SqliteStore& store, const std::string& id, std::uint64_t epoch = 1);
/// The step to `revision` that sets the light "Lamp" to the mesh `mesh` and red radiance `revision`, as edit of "me".
pb::Record lampRecord(std::uint64_t revision, const std::string& mesh = "mesh-a");
/// That step, bringing `bytes` as the mesh where they are not there yet.
MakeLogRecord lampStep(std::uint64_t revision, const std::string& mesh = "mesh-a",
                       const std::string& bytes = "bytes of a");
/// What became of a position, of a session that is not fenced or of `session`; waits.
Status keptAt(CommitQueue& store, Position position, const std::string& session = {});

/// The single number of a query on the store's database, over a connection of its own.
std::int64_t ask(const Folder& folder, const std::string& sql);
/// Changes the database behind the store's back.
void tamper(const Folder& folder, const std::string& sql);

}  // namespace lpv::store
