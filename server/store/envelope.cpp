#include "store/envelope.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include "lpv/store/v1/store.pb.h"
#include "wire/volume_codec.h"

namespace lpv::store {
namespace {

constexpr std::uint32_t kOldest = kSchemaVersion > 1 ? kSchemaVersion - 1 : 1;

Status lost(const std::string& what, const std::string& why) {
  return {Code::kDataLoss, what + " is damaged: " + why + "; restore it from a backup"};
}

}  // namespace

Status checkVersion(const std::string& what, std::uint32_t version) {
  if (version >= kOldest && version <= kSchemaVersion) return {};
  return {Code::kFailedPrecondition,
          what + " has schema version " + std::to_string(version) + ", this lpvd reads " + std::to_string(kOldest) +
              " to " + std::to_string(kSchemaVersion) +
              (version > kSchemaVersion ? "; use the newer lpvd that wrote it" : "; go through the versions between")};
}

Expected<std::string> seal(const std::string& what, const google::protobuf::MessageLite& message) {
  v1::Envelope envelope;
  envelope.set_schema_version(kSchemaVersion);
  std::string out;
  bool written = message.SerializeToString(envelope.mutable_payload());
  if (written) {
    envelope.set_checksum(wire::checksumBytes(envelope.payload().data(), envelope.payload().size()));
    written = envelope.SerializeToString(&out);
  }
  if (written) return out;
  return exhausted("data", what + " has " + std::to_string(message.ByteSizeLong()) +
                               " bytes, more than can be written; remove some of what it holds");
}

std::string sealSerialized(std::string payload) {
  constexpr std::uint32_t kBytesField = 2;  // wire type of what has a length
  v1::Envelope envelope;
  envelope.set_schema_version(kSchemaVersion);
  envelope.set_checksum(wire::checksumBytes(payload.data(), payload.size()));
  std::string head = envelope.SerializeAsString();
  {
    google::protobuf::io::StringOutputStream stream(&head);
    google::protobuf::io::CodedOutputStream out(&stream);
    out.WriteTag(std::uint32_t(v1::Envelope::kPayloadFieldNumber) << 3U | kBytesField);
    out.WriteVarint32(std::uint32_t(payload.size()));
  }
  payload.insert(0, head);
  return payload;
}

Status unseal(const std::string& what, const std::string& sealed, google::protobuf::MessageLite* message) {
  v1::Envelope envelope;
  if (!envelope.ParseFromString(sealed)) return lost(what, "it is no envelope");
  if (envelope.schema_version() == 0) return lost(what, "it has no schema version");
  if (Status s = checkVersion(what, envelope.schema_version()); !s.ok()) return s;
  if (wire::checksumBytes(envelope.payload().data(), envelope.payload().size()) != envelope.checksum()) {
    return lost(what, "its checksum is another");
  }
  if (!message->ParseFromString(envelope.payload())) return lost(what, "it does not parse");
  return {};
}

}  // namespace lpv::store
