#pragma once
// Where sessions are kept, as sessions see it; the rule for acknowledgements is in store/commit_queue.h. Calls that
// change something take pointers and return at once: they are made under a session's lock, so that the order kept is
// the order of revisions.

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "session/state.h"

namespace lpv {

/// A step of a session.
struct JournalStep {
  Changes changes;  ///< Document::lastChange; of an edit that changed nothing, the revision alone
  std::optional<SessionSettings> settings;  ///< both, where one of them changed
  std::string client;  ///< who got `outcome`
  std::optional<EditOutcome> outcome;  ///< set where it is remembered
  std::optional<ClientState> joined;
  std::string left;
  BlobPtr upload;
  std::vector<BlobHash> dropped;  ///< uploads that nothing referred to for long
};

/// Thread-safe.
class Journal {
 public:
  virtual ~Journal() = default;

  virtual Durability durability() const = 0;
  /// Ok, or why nothing can be kept now: no session may be made.
  virtual Status available() const = 0;
  /// Ok, or why this session may not be changed now: available(), or another server owns it.
  virtual Status writable(const std::string& session) const = 0;
  virtual Position create(const SavedSession& state) = 0;
  virtual Position append(const std::string& session, JournalStep step) = 0;
  /// Takes the session under this epoch, which must be kept before anybody sees it.
  virtual Position setEpoch(const std::string& session, std::uint64_t epoch) = 0;
  virtual Position touch(const std::string& session, std::chrono::system_clock::time_point used) = 0;
  virtual Position remove(const std::string& session) = 0;
  /// Goes with its session, or with dropToken.
  virtual Position keepToken(const AccessToken& token) = 0;
  virtual Position dropToken(const std::string& session, const std::string& tokenId) = 0;
  /// Calls `kept` once, with ok when everything up to there is kept, or with why that is not known. `position` is a
  /// change of `session`.
  virtual void whenDurable(const std::string& session, Position position, std::function<void(const Status&)> kept) = 0;
  /// Waits for what was given so far. Not under a lock.
  virtual Status flush() = 0;

  // Reading; may take as long as the disk does. A session's geometry is parsed and checked like an upload's.
  virtual Expected<std::vector<SessionHead>> heads() = 0;
  virtual Expected<std::vector<AccessToken>> tokens() = 0;
  virtual Expected<SavedSession> load(const std::string& session) = 0;
  virtual Expected<SessionSummary> summary(const std::string& session) = 0;
  /// At least the highest epoch of any session that was ever kept here.
  virtual std::uint64_t highestEpoch() = 0;
};

}  // namespace lpv
