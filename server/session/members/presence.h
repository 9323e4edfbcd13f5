#pragma once
// Who is in a session, and what they look at. Transient: in no log, not undone, forgotten with the process.

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/status.h"
#include "base/timers.h"
#include "base/token_bucket.h"
#include "scene/camera.h"
#include "session/limits.h"

namespace lpv {

inline constexpr std::size_t kMaxDisplayNameBytes = 100;
inline constexpr std::size_t kMaxSelection = 64;

/// A member as the others see it.
struct Presence {
  std::string displayName;           ///< at most kMaxDisplayNameBytes
  glm::dvec3 colour{0.0};            ///< linear Rec.709, 0..1
  std::optional<Camera> camera;      ///< where it looks from
  std::vector<std::string> selection;  ///< names of objects, at most kMaxSelection
  std::vector<std::string> locked;     ///< what it has locked (session/members/locks.h)
};

/// What a member says of itself: all of it, but for a name and a colour that it leaves out.
struct PresenceUpdate {
  std::optional<std::string> displayName;
  std::optional<glm::dvec3> colour;
  std::optional<Camera> camera;
  std::vector<std::string> selection;
};

/// INVALID_ARGUMENT, by field.
Status checkPresence(const PresenceUpdate& update);

/// A member's presence and the number of its last change; numbers rise over all members.
struct PresentMember {
  Presence presence;
  std::uint64_t change = 0;
};
using PresenceSnapshot = std::map<std::string, PresentMember>;

/// The members of one session that are there to be seen. Not thread-safe: the session's lock guards it.
class PresenceTable {
 public:
  explicit PresenceTable(const Limits& limits) : limits_(limits) {}
  /// From now on; what is there stays.
  void setLimits(const Limits& limits) { limits_ = limits; }

  /// A new member, who is seen at once where it says a name or a colour.
  void join(const std::string& client, const PresenceUpdate& update, Clock::time_point now);
  /// RESOURCE_EXHAUSTED (max_presence_updates_per_second) where the member says more than that.
  Status update(const std::string& client, const PresenceUpdate& update, Clock::time_point now);
  /// The member is there still.
  void markActive(const std::string& client, Clock::time_point now);
  void leave(const std::string& client);
  /// A member that holds locks is listed even without other presence.
  void setLocked(const std::string& client, const std::vector<std::string>& names);
  /// Those who are not in `connected` and were not heard of for limits.presenceIdle are gone.
  void dropSilent(const std::set<std::string>& connected, Clock::time_point now);

  const PresenceSnapshot& members() const { return members_; }
  /// Rises with every change, of whatever kind.
  std::uint64_t changes() const { return changes_; }

 private:
  struct Heard {
    Clock::time_point last;
    TokenBucket updates;
  };
  void put(const std::string& client, const PresenceUpdate& update);
  Status admit(const std::string& client, Clock::time_point now);

  Limits limits_;
  PresenceSnapshot members_;
  std::map<std::string, Heard> heard_;  ///< of everybody who ever said something, until it leaves
  std::uint64_t changes_ = 0;
};

}  // namespace lpv
