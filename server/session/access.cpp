#include "session/access.h"

#include <algorithm>
#include <utility>

#include "base/digest.h"
#include "base/text.h"
#include "session/members/members.h"

namespace lpv {
namespace {

constexpr std::chrono::seconds kExpiryInterval{1};
constexpr std::chrono::hours kExpiredKept{24};  ///< so that its bearer can be told what is wrong with it
constexpr std::size_t kLeastAdminBytes = 16;
constexpr std::size_t kMostTokenBytes = 512;
constexpr const char* kPrefix = "lpv_";
constexpr std::size_t kIdBytes = 8;
constexpr std::size_t kSecretBytes = 16;

Status unauthenticated(const std::string& why) { return {Code::kUnauthenticated, why, "authorization"}; }

Status unknownToken() {
  return unauthenticated("authorization: the access token is not known here: mistyped, revoked, or another server's");
}

Status revokedToken() { return unauthenticated("authorization: the access token has been revoked"); }

Status expiredToken() {
  return unauthenticated("authorization: the access token has expired; ask an owner for another");
}

/// The id in "lpv_ID_SECRET"; empty for anything else.
std::string idOf(const std::string& token) {
  const std::size_t begin = std::string(kPrefix).size();
  const std::size_t end = begin + 2 * kIdBytes;
  if (!token.starts_with(kPrefix) || token.size() != end + 1 + 2 * kSecretBytes || token[end] != '_') return {};
  return token.substr(begin, 2 * kIdBytes);
}

}  // namespace

const char* roleName(Role role) {
  switch (role) {
    case Role::kViewer:
      return "viewer";
    case Role::kEditor:
      return "editor";
    case Role::kOwner:
      return "owner";
    case Role::kAdmin:
      return "admin";
  }
  return "";
}

Access::Access(Journal& journal, Timers& timers) : journal_(journal), timers_(timers) { sweepLater(); }

Access::~Access() {
  const MutexLock lock(mutex_);
  *alive_ = false;
}

Status Access::open() {
  Expected<std::vector<AccessToken>> kept = journal_.tokens();
  if (!kept) return kept.status();
  const MutexLock lock(mutex_);
  for (AccessToken& token : *kept) tokens_[token.id] = std::move(token);
  return {};
}

Status Access::require(const std::string& adminToken) {
  if (adminToken.size() < kLeastAdminBytes || adminToken.size() > kMostTokenBytes) {
    return invalid("admin-token-file", "the admin token has " + std::to_string(adminToken.size()) +
                                           " bytes, allowed are 16 to 512; `openssl rand -hex 32` makes a good one");
  }
  const MutexLock lock(mutex_);
  adminHash_ = sha256(adminToken);
  return {};
}

bool Access::required() const {
  const MutexLock lock(mutex_);
  return !adminHash_.empty();
}

Expected<Grant> Access::verify(const std::string& token) const {
  const MutexLock lock(mutex_);
  if (adminHash_.empty()) return Grant{};
  if (token.empty()) {
    return unauthenticated(
        "authorization is missing: this server asks for an access token, as \"Bearer TOKEN\" "
        "(lpvctl: --token-file FILE or LPV_TOKEN)");
  }
  if (token.size() > kMostTokenBytes) return unknownToken();
  const std::string hash = sha256(token);
  if (hash == adminHash_) return Grant{};
  const auto found = tokens_.find(idOf(token));
  if (found == tokens_.end() || found->second.hash != hash) return unknownToken();
  if (std::chrono::system_clock::now() >= found->second.expires) return expiredToken();
  return Grant{found->second.role, found->second.session, found->first};
}

Expected<MintedToken> Access::mint(const std::string& session, Role role, std::chrono::seconds life) {
  if (life.count() <= 0 || life > kMaxTokenLife) {
    return invalid("ttl", "ttl is " + std::to_string(life.count()) + " s, allowed are more than 0 to " +
                              std::to_string(std::chrono::seconds(kMaxTokenLife).count()) + " s");
  }
  MintedToken out;
  out.kept.id = randomHex(kIdBytes);
  out.token = kPrefix + out.kept.id + "_" + randomHex(kSecretBytes);
  out.kept.session = session;
  out.kept.role = role;
  out.kept.hash = sha256(out.token);
  out.kept.expires = std::chrono::system_clock::now() + life;
  const MutexLock lock(mutex_);
  const auto ours =
      std::count_if(tokens_.begin(), tokens_.end(), [&](const auto& entry) { return entry.second.session == session; });
  if (std::size_t(ours) >= kMaxTokensPerSession) {
    return exhausted("session", "session \"" + session + "\" has " + std::to_string(ours) +
                                    " access tokens, which is the most allowed; revoke some");
  }
  tokens_[out.kept.id] = out.kept;
  out.position = journal_.keepToken(out.kept);
  return out;
}

std::vector<AccessToken> Access::tokensOf(const std::string& session) const {
  const MutexLock lock(mutex_);
  const auto now = std::chrono::system_clock::now();
  std::vector<AccessToken> out;
  for (const auto& [id, token] : tokens_) {
    if (token.session == session && now < token.expires) out.push_back(token);
  }
  return out;
}

Expected<Position> Access::revoke(const std::string& session, const std::string& tokenId) {
  Ended ended;
  Position gone = 0;
  {
    const MutexLock lock(mutex_);
    const auto found = tokens_.find(tokenId);
    if (found == tokens_.end() || found->second.session != session) {
      return Status(Code::kNotFound,
                    "session \"" + session + "\" has no access token \"" + truncatedUtf8(tokenId) +
                        "\"; it may have been revoked or have expired",
                    "token_id");
    }
    tokens_.erase(found);
    gone = journal_.dropToken(session, tokenId);
    ended = takeWatchers(tokenId);
  }
  for (const auto& tell : ended) tell(revokedToken());
  return gone;
}

void Access::forget(const std::string& session) {
  const MutexLock lock(mutex_);
  std::erase_if(tokens_, [&](const auto& entry) { return entry.second.session == session; });
}

std::shared_ptr<void> Access::watch(const Grant& grant, std::function<void(const Status&)> ended) {
  if (grant.tokenId.empty()) return nullptr;
  MutexLock lock(mutex_);
  if (!tokens_.contains(grant.tokenId)) {  // went after it was verified
    lock.unlock();
    ended(revokedToken());
    return nullptr;
  }
  const std::uint64_t key = nextWatcher_++;
  watchers_[key] = {grant.tokenId, std::move(ended)};
  return std::shared_ptr<void>(nullptr, [this, key, alive = std::weak_ptr<bool>(alive_)](void*) {
    if (alive.expired()) return;
    const MutexLock inner(mutex_);
    watchers_.erase(key);
  });
}

Access::Ended Access::takeWatchers(const std::string& tokenId) {
  Ended out;
  for (auto it = watchers_.begin(); it != watchers_.end();) {
    if (it->second.tokenId == tokenId) {
      out.push_back(std::move(it->second.ended));
      it = watchers_.erase(it);
    } else {
      ++it;
    }
  }
  return out;
}

void Access::sweepLater() {
  timers_.at(Clock::now() + kExpiryInterval, [this, alive = std::weak_ptr<bool>(alive_)] {
    if (alive.expired()) return;
    sweep();
    sweepLater();
  });
}

void Access::sweep() {
  Ended ended;
  {
    const MutexLock lock(mutex_);
    const auto now = std::chrono::system_clock::now();
    for (auto it = tokens_.begin(); it != tokens_.end();) {
      if (now >= it->second.expires) {
        for (auto& tell : takeWatchers(it->first)) ended.push_back(std::move(tell));
      }
      if (now >= it->second.expires + kExpiredKept) {
        (void)journal_.dropToken(it->second.session, it->first);
        it = tokens_.erase(it);
      } else {
        ++it;
      }
    }
  }
  for (const auto& tell : ended) tell(expiredToken());
}

}  // namespace lpv
