#include "api/presence_feed.h"

#include "convert/presence.h"

namespace lpv::api {

bool PresenceFeed::next(const Session& session, pb::Presence* out) {
  const std::uint64_t changes = session.presenceChanges();
  if (changes == seen_) return false;
  const PresenceSnapshot members = session.presenceSnapshot();
  for (const auto& [client, change] : told_) {
    if (members.contains(client)) continue;
    out->set_client_id(client);
    out->set_gone(true);
    told_.erase(out->client_id());
    return true;
  }
  for (const auto& [client, member] : members) {
    if (client == self_) continue;
    std::uint64_t& told = told_[client];
    if (told == member.change) continue;
    told = member.change;
    toProto(client, member.presence, out);
    return true;
  }
  seen_ = changes;
  return false;
}

}  // namespace lpv::api
