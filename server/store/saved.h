#pragma once
// What the journal of a session and the store's tables both name. Plain values: no messages, no database.

#include <chrono>
#include <cstdint>
#include <string>

namespace lpv {

/// What a caller may do, in the sessions that its token is for. Each role may do what those before it may. The numbers
/// are those of lpv.v1.Role, which is what the store keeps; the wire has no admin.
enum class Role {
  kViewer = 1,  ///< read the scene and results, be a member
  kEditor = 2,  ///< edit, upload, change settings
  kOwner = 3,   ///< delete the session, make and revoke tokens
  kAdmin = 4,   ///< make sessions, list them all, read the server's statistics
};

/// An access token as it is kept.
struct AccessToken {
  std::string id;  ///< 16 hexadecimal digits; no secret
  std::string session;
  Role role = Role::kViewer;
  std::string hash;  ///< SHA-256 of the whole token
  std::chrono::system_clock::time_point expires;
};

/// What is known of a saved session without reading it.
struct SessionHead {
  std::string id;
  std::uint64_t epoch = 0;
  std::string requestId;  ///< of the CreateSession that made it; may be empty
  std::chrono::system_clock::time_point created;
  std::chrono::system_clock::time_point lastUsed;
  std::chrono::seconds ttl{0};  ///< 0: never expires
};

/// How far changes have been taken: 1 is the first, 0 is before it. One count for all sessions.
using Position = std::uint64_t;

}  // namespace lpv
