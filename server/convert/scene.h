#pragma once
// Messages of scene.proto to domain edits, and scene changes to messages.

#include <functional>
#include <string>
#include <vector>

#include "lpv/v1/scene.pb.h"
#include "scene/edits.h"
#include "session/session.h"

namespace lpv::api {

namespace pb = lpv::v1;

/// Checks form and limits and parses bulk data; may take milliseconds, so call it on a worker.
Expected<Edit> fromProto(const pb::Edit& edit, const Limits& limits);

void toProto(const Versioned<Light>& light, pb::Light* out);
void toProto(const Versioned<Surface>& surface, pb::Surface* out);
void toProto(const Status& status, pb::Status* out);
Status fromProto(const pb::Status& status);
/// An outcome as `session` tells it.
void toProto(const EditOutcome& outcome, const Session& session, pb::EditAck* out);

/// Changes as messages below the size limit: a snapshot or a change in one or more parts.
std::vector<pb::WatchSceneResponse> toProto(const Changes& changes, std::uint64_t epoch, std::uint64_t since,
                                            const std::map<std::string, std::uint64_t>& clientSequences);

}  // namespace lpv::api
