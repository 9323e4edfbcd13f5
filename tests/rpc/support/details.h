#pragma once
// The details of a refusal beside its field: why, and when to ask again.

#include <grpcpp/support/status.h>

#include "lpv/v1/status.pb.h"

namespace lpv::rpc {

/// The detail of that type; an empty one where there is none.
template <typename Detail>
Detail detailOf(const grpc::Status& status, const std::string& type) {
  lpv::v1::Status all;
  Detail out;
  if (!all.ParseFromString(status.error_details())) return out;
  for (const google::protobuf::Any& any : all.details()) {
    if (any.type_url() == "type.googleapis.com/google.rpc." + type && out.ParseFromString(any.value())) return out;
  }
  return out;
}
inline std::string reasonOf(const grpc::Status& status) {
  return detailOf<lpv::v1::ErrorInfo>(status, "ErrorInfo").reason();
}
/// Seconds; 0 where the refusal has none.
inline double pauseOf(const grpc::Status& status) {
  const auto pause = detailOf<lpv::v1::RetryInfo>(status, "RetryInfo").retry_delay();
  return double(pause.seconds()) + 1e-9 * pause.nanos();
}

}  // namespace lpv::rpc
