#pragma once
// Messages about members to domain values and back.

#include <string>

#include "lpv/v1/session.pb.h"
#include "session/members/presence.h"

namespace lpv::api {

namespace pb = lpv::v1;

/// How a member that joins is seen.
PresenceUpdate fromProto(const pb::JoinSessionRequest& request);
/// INVALID_ARGUMENT for a camera out of range; the rest is the domain's to check.
Expected<PresenceUpdate> fromProto(const pb::Presence& presence);

void toProto(const std::string& client, const Presence& presence, pb::Presence* out);

}  // namespace lpv::api
