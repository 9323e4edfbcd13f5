#pragma once
// Messages of session.proto to domain values and back.

#include <google/protobuf/field_mask.pb.h>

#include <string>

#include "lpv/v1/session.pb.h"
#include "scene/options.h"
#include "session/session.h"

namespace lpv::api {

namespace pb = lpv::v1;

/// "sessions/{id}" to the id. INVALID_ARGUMENT at `field` for another form.
Expected<std::string> sessionId(const std::string& field, const std::string& name);
std::string sessionName(const std::string& id);

/// Settings of a new session: what is not said belongs to the transport, and that to what is said. Unknown enum values
/// are INVALID_ARGUMENT; ranges, and what does not go together, are the domain's business.
Expected<SessionSettings> fromProto(const pb::SessionSettings& settings);
/// `current` with the masked fields ("settings.iterations", "settings.grid", ...) taken from `settings`. Another
/// transport brings its injection and lookup where the mask does not name them.
Expected<SessionSettings> withMask(const SessionSettings& current, const pb::SessionSettings& settings,
                                   const google::protobuf::FieldMask& mask);

void toProto(const LightingSettings& options, pb::SessionSettings* out);
void toProto(const SessionSummary& summary, pb::Session* out);
pb::Durability toProto(Durability durability);

pb::Role toProto(Role role);
/// INVALID_ARGUMENT for none, or one that is not known.
Expected<Role> roleOf(pb::Role role);

ClientIdentity fromProto(const pb::ClientIdentity& identity);
/// INVALID_ARGUMENT at "sequence" for one that a request with this identity cannot carry: 0, and above 2^63-1. Requests
/// without an identity have none.
Status checkSequence(const ClientIdentity& client, std::uint64_t sequence);

}  // namespace lpv::api
