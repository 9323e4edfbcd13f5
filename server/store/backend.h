#pragma once
// Where sessions are kept: tables, changed in groups. The queue before them is store/commit_queue.h.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/status.h"
#include "lpv/store/v1/store.pb.h"
#include "store/saved.h"

namespace lpv::store {

namespace pb = lpv::store::v1;

/// Bytes named by their SHA-256.
struct Content {
  std::string hash;
  lpv::v1::BlobKind kind = lpv::v1::BLOB_KIND_UNSPECIFIED;
  std::shared_ptr<const std::string> bytes;
};

/// A session as it is kept, its log folded into its snapshot.
struct Loaded {
  SessionHead head;
  pb::Snapshot snapshot;
  std::vector<Content> contents;  ///< what objects refer to and what was uploaded, each once; empty where not asked for
};

/// All of a session with the bytes that it needs.
struct FullSnapshot {
  pb::Snapshot snapshot;
  std::vector<Content> contents;
};

/// A record of a session's log with the bytes it brings.
struct LogRecord {
  pb::Record record;
  std::vector<Content> contents;
};
/// Whether the session's bytes of that hash are kept already.
using HasContent = std::function<bool(const std::string& hash)>;
/// Makes a record; called within the group's transaction, again after a rollback, or never.
using MakeLogRecord = std::function<LogRecord(const HasContent&)>;

/// What became of one change within its group.
class Written {
 public:
  /// Ok: written. Not ok: the group cannot be committed; it is rolled back and tried again.
  Written(Status status) : status_(std::move(status)) {}  // NOLINT(google-explicit-constructor): as Status is returned
  /// Nothing was written, because another server owns the session by now; the rest of the group is not concerned.
  static Written fenced(Status why) {
    Written out(std::move(why));
    out.fenced_ = true;
    return out;
  }

  bool isFenced() const { return fenced_; }
  const Status& status() const { return status_; }

 private:
  Status status_;
  bool fenced_ = false;
};

/// The tables. Changes come from one thread, between begin() and commit() or rollback(); reading is thread-safe and
/// sees committed groups only. A backend neither queues nor retries: CommitQueue does.
class Backend {
 public:
  virtual ~Backend() = default;

  /// How long a committed group is sure to live.
  virtual lpv::v1::Durability durability() const = 0;

  // A group. UNAVAILABLE, naming the place and the way out, where it cannot be written.
  virtual Status begin() = 0;
  /// Returns ok when the group is as durable as durability() says.
  virtual Status commit() = 0;
  virtual void rollback() = 0;

  // Changes within a group.
  virtual Written create(const SessionHead& head, const FullSnapshot& whole) = 0;
  virtual Written append(const std::string& session, const MakeLogRecord& make) = 0;
  virtual Written setEpoch(const std::string& session, std::uint64_t epoch) = 0;
  virtual Written touch(const std::string& session, std::chrono::system_clock::time_point used) = 0;
  virtual Written remove(const std::string& session) = 0;  ///< its tokens too
  /// No-op for a session that is not there.
  virtual Written keepToken(const AccessToken& token) = 0;
  virtual Written dropToken(const std::string& tokenId) = 0;

  /// Called between groups, after the last one's changes were acknowledged: folds logs that have grown long. What fails
  /// here leaves the log as it was and is logged.
  virtual void maintain() = 0;

  // Reading.
  virtual Expected<std::vector<SessionHead>> heads() = 0;
  virtual Expected<std::vector<AccessToken>> tokens() = 0;
  /// NOT_FOUND; DATA_LOSS where what is kept cannot be read as what was written.
  virtual Expected<Loaded> load(const std::string& session, bool withContents) = 0;
  /// At least the highest epoch that any session had here when the backend was opened; 0 for none.
  virtual std::uint64_t highestEpoch() const = 0;
};

}  // namespace lpv::store
