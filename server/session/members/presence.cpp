#include "session/members/presence.h"

#include <algorithm>
#include <cmath>

#include "scene/edits.h"
#include "scene/words.h"

namespace lpv {

Status checkPresence(const PresenceUpdate& update) {
  const std::size_t bytes = update.displayName ? update.displayName->size() : 0;
  if (bytes > kMaxDisplayNameBytes) {
    return invalid("display_name", "display_name has " + std::to_string(bytes) + " bytes, allowed are " +
                                       std::to_string(kMaxDisplayNameBytes));
  }
  if (Status s = checkVisible("display_name", update.displayName.value_or("")); !s.ok()) return s;
  for (int c = 0; update.colour && c < 3; ++c) {
    const double value = (*update.colour)[c];
    if (std::isfinite(value) && value >= 0.0 && value <= 1.0) continue;
    return invalid("colour",
                   std::string("colour.") + "xyz"[c] + " is " + std::to_string(value) + ", allowed are 0 to 1");
  }
  if (update.camera) {
    if (Status s = checkCamera(*update.camera); !s.ok()) return s.within("camera");
  }
  if (update.selection.size() > kMaxSelection) {
    return invalid("selection", "selection has " + std::to_string(update.selection.size()) + " names, allowed are " +
                                    std::to_string(kMaxSelection));
  }
  for (const std::string& name : update.selection) {
    if (const Status s = checkName(name); !s.ok()) return invalid("selection", "selection: " + s.message());
  }
  return {};
}

void PresenceTable::join(const std::string& client, const PresenceUpdate& update, Clock::time_point now) {
  heard_.insert_or_assign(client, Heard{now, {limits_.maxPresenceUpdatesPerSecond, now}});
  if (update.displayName || update.colour) put(client, update);
}

Status PresenceTable::update(const std::string& client, const PresenceUpdate& update, Clock::time_point now) {
  if (Status s = admit(client, now); !s.ok()) return s;
  put(client, update);
  return {};
}

void PresenceTable::markActive(const std::string& client, Clock::time_point now) {
  const auto found = heard_.find(client);
  if (found != heard_.end()) found->second.last = now;
}

void PresenceTable::leave(const std::string& client) {
  heard_.erase(client);
  if (members_.erase(client) != 0) ++changes_;
}

void PresenceTable::setLocked(const std::string& client, const std::vector<std::string>& names) {
  const auto found = members_.find(client);
  if (found == members_.end() && names.empty()) return;
  const Clock::time_point now = Clock::now();
  if (found == members_.end()) heard_.try_emplace(client, Heard{now, {limits_.maxPresenceUpdatesPerSecond, now}});
  PresentMember& member = members_[client];
  if (member.presence.locked == names) return;
  member.presence.locked = names;
  member.change = ++changes_;
}

void PresenceTable::dropSilent(const std::set<std::string>& connected, Clock::time_point now) {
  for (const std::string& client : connected) markActive(client, now);
  const std::size_t gone = std::erase_if(members_, [&](const auto& member) {
    return member.second.presence.locked.empty() && now - heard_.at(member.first).last > limits_.presenceIdle;
  });
  if (gone != 0) ++changes_;
}

void PresenceTable::put(const std::string& client, const PresenceUpdate& update) {
  PresentMember& member = members_[client];
  member.change = ++changes_;
  member.presence.displayName = update.displayName.value_or(member.presence.displayName);
  member.presence.colour = update.colour.value_or(member.presence.colour);
  member.presence.camera = update.camera;
  member.presence.selection = update.selection;
}

Status PresenceTable::admit(const std::string& client, Clock::time_point now) {
  const double rate = limits_.maxPresenceUpdatesPerSecond;
  Heard& heard = heard_.try_emplace(client, Heard{now, {rate, now}}).first->second;
  heard.last = now;
  if (heard.updates.take(rate, now)) return {};
  return exhausted(Reason::kMaxPresenceUpdatesPerSecond, "max_presence_updates_per_second",
                   "max_presence_updates_per_second: allowed are " + std::to_string(rate) +
                       " updates a second per client; send the newest a little later");
}

}  // namespace lpv
