#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/status.h"
#include "base/timers.h"
#include "base/token_bucket.h"
#include "session/limits.h"

namespace lpv {

/// What became of an edit; kept so that a repeated sequence gets the same answer.
struct EditOutcome {
  std::uint64_t sequence = 0;
  Status status;
  std::uint64_t revision = 0;  ///< made, or current where rejected
  std::vector<std::string> names;
  std::vector<std::string> skipped = {};  ///< of an undo or redo: what was left as somebody else has written it
};

/// Who a client says it is.
struct ClientIdentity {
  std::string id;
  std::string secret;
};

/// A member as it is kept.
struct ClientState {
  std::string id;
  std::string secretHash;            ///< SHA-256 of the secret
  std::deque<EditOutcome> outcomes;  ///< oldest first, at most kRememberedOutcomes
  std::uint64_t outcomeHorizon = 0;   ///< sequences up to this may be missing from outcomes
  std::uint64_t acceptedSequence = 0;
  std::uint64_t acceptedRevision = 0;
};

/// The members of one session. Not thread-safe: the session's lock guards it.
class Members {
 public:
  explicit Members(const Limits& limits) : limits_(limits), nobody_(limits.maxEditsPerSecond, Clock::now()) {}
  /// From now on; what is there stays.
  void setLimits(const Limits& limits) { limits_ = limits; }

  /// A new identity: id and 128-bit secret. RESOURCE_EXHAUSTED when the session is full.
  Expected<ClientIdentity> join();
  /// Restores a member of the saved session.
  void restore(const ClientState& state);
  void leave(const std::string& id) { members_.erase(id); }
  /// The member is there still.
  void markActive(const std::string& id, Clock::time_point now);
  bool full() const { return std::ssize(members_) >= limits_.maxClientsPerSession; }
  /// Who was heard of longest ago, and not for limits.memberSilent; none of `connected`. Empty: nobody.
  std::string silent(const std::set<std::string>& connected, Clock::time_point now) const;
  /// A member as it is now.
  ClientState state(const std::string& id) const { return members_.at(id); }
  /// PERMISSION_DENIED unless the identity was issued here. An empty identity is nobody: ok.
  Status verify(const ClientIdentity& identity) const;

  /// The outcome of an edit seen before; FAILED_PRECONDITION for a sequence that is not above the highest answered and
  /// has no outcome (any more).
  Expected<std::optional<EditOutcome>> repeated(const std::string& id, std::uint64_t sequence) const;
  /// RESOURCE_EXHAUSTED when the client edits faster than max_edits_per_second. Not an outcome: retry. All who do not
  /// say who they are count as one client.
  Status admit(const std::string& id, Clock::time_point now);
  void record(const std::string& id, const EditOutcome& outcome);

  /// Highest sequence accepted from `id`; 0 for nobody.
  std::uint64_t acceptedSequence(const std::string& id) const;
  /// Members whose last accepted edit is newer than revision `since`, with its sequence.
  std::map<std::string, std::uint64_t> sequencesSince(std::uint64_t since) const;
  std::size_t count() const { return members_.size(); }

 private:
  struct Client : ClientState {
    TokenBucket edits;
    Clock::time_point heard;
    std::size_t nameBytes = 0;  ///< of its outcomes
  };
  static void forgetOldest(Client& client);
  /// The highest sequence that was answered, accepted or refused.
  static std::uint64_t highest(const ClientState& client);
  Limits limits_;
  std::map<std::string, Client> members_;
  TokenBucket nobody_;  ///< edits
};

/// Outcomes kept per client (PROTOCOL.md) ...
inline constexpr std::size_t kRememberedOutcomes = 1024;
/// ... and bytes of the names in them: those of a thousand edits of a thousand objects each would be hundreds of
/// megabytes. The newest stays, whatever it has.
inline constexpr std::size_t kRememberedNameBytes = std::size_t(4) << 20;
inline constexpr std::size_t kRememberedBytesPerName = 32;  ///< besides its own

/// `bytes` random bytes from the operating system, in lower-case hexadecimal.
std::string randomHex(std::size_t bytes);

}  // namespace lpv
