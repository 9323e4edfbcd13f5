#pragma once
// The gRPC door: each method hands over to api/services.h. Methods that are not overridden answer UNIMPLEMENTED.

#include <grpcpp/server_builder.h>

#include <memory>

#include "api/call/context.h"

namespace lpv::door {

/// The five services over one context, which outlives them.
class Services {
 public:
  explicit Services(api::Context& context);
  ~Services();
  void registerWith(grpc::ServerBuilder& builder);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace lpv::door
