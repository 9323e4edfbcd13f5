#pragma once
// Who may do what: access tokens (PROTOCOL.md, "Doors, tokens, limits").

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "base/status.h"
#include "base/timers.h"
#include "session/journal.h"

namespace lpv {

/// "viewer", "editor", "owner", "admin".
const char* roleName(Role role);

/// A caller who has shown a token, or anybody where none is asked for.
struct Grant {
  Role role = Role::kAdmin;
  std::string session;  ///< the one it is for; empty for an admin
  std::string tokenId;  ///< empty for an admin
};

/// A token as its owner gets it, once.
struct MintedToken {
  std::string token;  ///< "lpv_", the id, "_", 128 random bits in hexadecimal
  AccessToken kept;
  Position position = 0;  ///< where the journal has it
};

/// Tokens that were not revoked, of one session.
inline constexpr std::size_t kMaxTokensPerSession = 1000;
inline constexpr std::chrono::hours kDefaultTokenLife{24 * 30};
inline constexpr std::chrono::hours kMaxTokenLife{24 * 3650};

/// The tokens of this server. Secrets are kept hashed (SHA-256). Thread-safe.
class Access {
 public:
  /// Both outlive this. Until require() everybody is an admin.
  Access(Journal& journal, Timers& timers);
  ~Access();

  /// Learns which tokens are kept. Once, before the first call; or why they cannot be read.
  Status open();
  /// From now on every call needs a token, and `adminToken`, at least 16 bytes, is the admin's: the one before it is
  /// refused from now on, streams that it has opened go on.
  Status require(const std::string& adminToken);
  bool required() const;

  /// UNAUTHENTICATED without a token that is known and has not expired.
  Expected<Grant> verify(const std::string& token) const;

  /// A token for one session, for `life` from now. INVALID_ARGUMENT for a life that is not above 0 or longer than
  /// kMaxTokenLife; RESOURCE_EXHAUSTED at kMaxTokensPerSession.
  Expected<MintedToken> mint(const std::string& session, Role role, std::chrono::seconds life);
  /// Those of a session that have not expired, ordered by id.
  std::vector<AccessToken> tokensOf(const std::string& session) const;
  /// NOT_FOUND where the session has no such token. Ends what it has opened; the position is where the journal has it.
  Expected<Position> revoke(const std::string& session, const std::string& tokenId);
  /// Drops the tokens of a session that is gone; the journal drops them with it.
  void forget(const std::string& session);

  /// Calls `ended` once (any thread, no locks) when the grant's token is revoked or expires, unless what is returned
  /// has gone before; at once where that has happened already.
  std::shared_ptr<void> watch(const Grant& grant, std::function<void(const Status&)> ended);

  /// Ends what expired tokens have opened, and drops those that expired a day ago. Runs by itself once a second.
  void sweep();

 private:
  struct Watcher {
    std::string tokenId;
    std::function<void(const Status&)> ended;
  };
  using Ended = std::vector<std::function<void(const Status&)>>;

  void sweepLater();
  Ended takeWatchers(const std::string& tokenId) LPV_REQUIRES(mutex_);

  Journal& journal_;
  Timers& timers_;
  mutable Mutex mutex_;
  std::string adminHash_ LPV_GUARDED_BY(mutex_);  ///< empty: no tokens are asked for
  std::map<std::string, AccessToken> tokens_ LPV_GUARDED_BY(mutex_);
  std::map<std::uint64_t, Watcher> watchers_ LPV_GUARDED_BY(mutex_);
  std::uint64_t nextWatcher_ LPV_GUARDED_BY(mutex_) = 1;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace lpv
