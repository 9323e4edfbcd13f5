#pragma once
// Messages as they lie on disk: with a schema version and a checksum.

#include <google/protobuf/message_lite.h>
#include <cstdint>
#include <string>

#include "base/status.h"

namespace lpv::store {

/// Of what this version writes. It reads this one and the one before (store.proto states the rule).
inline constexpr std::uint32_t kSchemaVersion = 1;

/// Ok for a version that can be read; FAILED_PRECONDITION, naming `what` and both versions, for another.
Status checkVersion(const std::string& what, std::uint32_t version);

/// RESOURCE_EXHAUSTED, naming `what`, for a message that protobuf cannot write (2 GiB).
Expected<std::string> seal(const std::string& what, const google::protobuf::MessageLite& message);
/// The same of a message that is serialised already, and shorter than 2 GiB: without a copy where `payload` has room
/// for kEnvelopeBytes more.
std::string sealSerialized(std::string payload);
inline constexpr std::size_t kEnvelopeBytes = 32;
/// FAILED_PRECONDITION for another schema version, DATA_LOSS for bytes that are not what was sealed; both name `what`.
Status unseal(const std::string& what, const std::string& sealed, google::protobuf::MessageLite* message);

}  // namespace lpv::store
