#include "grpc/status.h"

#include "base/text.h"
#include "convert/scene.h"

namespace lpv::grpc_door {

namespace {

/// A message may repeat a name as long as the caller made it. gRPC's clients take 8 KiB of trailers, where the message
/// stands twice and what is not ASCII takes three bytes each; beyond that they report a broken call instead.
constexpr std::size_t kMostTrailerText = 1200;

}  // namespace

grpc::Status toGrpc(const Status& status) {
  if (status.ok()) return grpc::Status::OK;
  const std::string message = truncatedUtf8(status.message(), kMostTrailerText);
  api::pb::Status details;
  api::toProto(Status(status.code(), status.reason(), message, truncatedUtf8(status.field(), kMostTrailerText))
                   .retriedAfter(status.retryAfter()),
               &details);
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()), message, details.SerializeAsString());
}

}  // namespace lpv::grpc_door
