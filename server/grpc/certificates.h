#pragma once

#include <grpcpp/security/server_credentials.h>

#include <memory>

#include "base/status.h"
#include "tls/follower.h"

namespace lpv::grpc_door {

/// Certificates for gRPC. Each that the follower gives is copied into a private folder, which goes with this, and put
/// in place by one rename; gRPC reads it there, so it never sees half a change.
class Certificates {
 public:
  /// UNAVAILABLE where no private folder can be made. The follower outlives this.
  static Expected<std::unique_ptr<Certificates>> of(tls::Follower& follower);
  ~Certificates();
  Certificates(const Certificates&) = delete;
  Certificates& operator=(const Certificates&) = delete;

  /// Connections made two seconds after a good change get the new files. Open connections stay as they are.
  std::shared_ptr<grpc::ServerCredentials> credentials() const;

 private:
  class Parts;
  explicit Certificates(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
  std::shared_ptr<void> following_;  ///< gone before parts_
};

}  // namespace lpv::grpc_door
