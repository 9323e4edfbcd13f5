#include "grpc/status.h"

#include "api/convert_scene.h"

namespace lpv::door {

grpc::Status toGrpc(const Status& status) {
  if (status.ok()) return grpc::Status::OK;
  api::pb::Status details;
  api::toProto(status, &details);
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()), status.message(), details.SerializeAsString());
}

}  // namespace lpv::door
