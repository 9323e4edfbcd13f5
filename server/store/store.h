#pragma once
// What outlives the process: a snapshot per session and the log of what changed since.
//
// The rule for acknowledgements. A change is made in memory first and may be seen by readers before it is kept; whoever
// made it is told only when it is. append() takes changes in order and never waits; whenDurable() tells when everything
// up to a position is kept. Where the state directory cannot be written,
//   - nothing that was taken is given up: the same changes, in the same order, are tried again until they are kept;
//   - everybody who waits is told UNAVAILABLE, naming the directory: the outcome is not known yet, and the sequence
//     repeated gets the true one;
//   - writable() is not ok until the store has caught up, and sessions refuse further changes with it, unapplied and
//     unrecorded, so that what is ahead of the disk stays what was in flight at the moment of the failure.
// So what is kept is at any time a prefix of what happened, and everything that was acknowledged is in it. A process
// that dies loses at most what nobody was told; its sequences are applied when they are repeated.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/status.h"
#include "lpv/store/v1/store.pb.h"

namespace lpv::store {

namespace pb = lpv::store::v1;

/// Bytes named by their SHA-256.
struct Content {
  std::string hash;
  lpv::v1::BlobKind kind = lpv::v1::BLOB_KIND_UNSPECIFIED;
  std::shared_ptr<const std::string> bytes;
};

/// What is known of a session without reading it.
struct Head {
  std::string id;
  std::uint64_t epoch = 0;
  std::string requestId;  ///< of the CreateSession that made it; may be empty
  std::chrono::system_clock::time_point created;
  std::chrono::system_clock::time_point lastUsed;
  std::chrono::seconds ttl{0};  ///< 0: never expires
};

/// An access token: its session, what it allows, and SHA-256 of its text.
struct Token {
  std::string id;
  std::string session;
  lpv::v1::Role role = lpv::v1::ROLE_UNSPECIFIED;
  std::string hash;
  std::chrono::system_clock::time_point expires;
};

/// A session as it is kept, its log folded into its snapshot.
struct Loaded {
  Head head;
  pb::Snapshot snapshot;
  std::vector<Content> contents;  ///< what objects refer to and what was uploaded, each once; empty where not asked for
};

/// All of a session with the bytes that it needs.
struct FullSnapshot {
  pb::Snapshot snapshot;
  std::vector<Content> contents;
};
/// As MakeLogRecord.
using MakeFullSnapshot = std::function<FullSnapshot()>;

/// A step of a session's log with the bytes it brings.
struct LogRecord {
  pb::Record record;
  std::vector<Content> contents;
};
/// Whether the session's bytes of that hash are kept already.
using HasContent = std::function<bool(const std::string& hash)>;
/// Makes a step; called on the store's thread, again after a failure, or never.
using MakeLogRecord = std::function<LogRecord(const HasContent&)>;

/// How far a store has taken changes. 0 is before the first.
using Position = std::uint64_t;
/// Ok, or why it is not known whether what was waited for is kept.
using Kept = std::function<void(const Status&)>;

/// Thread-safe. Changes of one session are kept in the order they were given.
class Store {
 public:
  virtual ~Store() = default;

  virtual lpv::v1::Durability durability() const = 0;
  /// Ok, or why changes should not be made now.
  virtual Status writable() const = 0;
  /// Changes that were given and are not kept yet.
  virtual std::int64_t queued() const = 0;

  // Changes: they return at once.
  virtual Position create(const Head& head, MakeFullSnapshot whole) = 0;
  virtual Position append(const std::string& session, MakeLogRecord step) = 0;
  virtual Position setEpoch(const std::string& session, std::uint64_t epoch) = 0;
  virtual Position touch(const std::string& session, std::chrono::system_clock::time_point used) = 0;
  virtual Position remove(const std::string& session) = 0;  ///< its tokens too
  virtual Position keepToken(const Token& token) = 0;
  virtual Position dropToken(const std::string& tokenId) = 0;

  /// Calls `kept` once: at once where `position` is kept or the store is failing, else on the store's executor.
  virtual void whenDurable(Position position, Kept kept) = 0;

  /// Waits until everything given so far is kept, or fails to be; needs no executor.
  virtual Status flush() = 0;

  // Reading: waits for the changes given so far.
  virtual Expected<std::vector<Head>> heads() = 0;
  virtual Expected<std::vector<Token>> tokens() = 0;
  /// NOT_FOUND; DATA_LOSS where what is kept cannot be read as what was written.
  virtual Expected<Loaded> load(const std::string& session, bool withContents) = 0;
  /// At least the highest epoch that any session ever had here; 0 for none.
  virtual std::uint64_t highestEpoch() = 0;
};

/// Keeps nothing: sessions live as long as the process. Durability MEMORY.
class MemoryStore final : public Store {
 public:
  lpv::v1::Durability durability() const override { return lpv::v1::DURABILITY_MEMORY; }
  Status writable() const override { return {}; }
  std::int64_t queued() const override { return 0; }
  Position create(const Head&, MakeFullSnapshot) override { return 0; }
  Position append(const std::string&, MakeLogRecord) override { return 0; }
  Position setEpoch(const std::string&, std::uint64_t) override { return 0; }
  Position touch(const std::string&, std::chrono::system_clock::time_point) override { return 0; }
  Position remove(const std::string&) override { return 0; }
  Position keepToken(const Token&) override { return 0; }
  Position dropToken(const std::string&) override { return 0; }
  void whenDurable(Position, Kept kept) override { kept({}); }
  Status flush() override { return {}; }
  Expected<std::vector<Head>> heads() override { return std::vector<Head>(); }
  Expected<std::vector<Token>> tokens() override { return std::vector<Token>(); }
  Expected<Loaded> load(const std::string& session, bool) override {
    return Status(Code::kNotFound, "there is no session \"" + session + "\"; this server keeps none on disk",
                  "session");
  }
  std::uint64_t highestEpoch() override { return 0; }
};

}  // namespace lpv::store
