#include "grpc/door.h"

#include <grpc/grpc.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/server_builder.h>

#include "grpc/call.h"
#include "session/limits.h"

namespace lpv::grpc_door {
namespace {

constexpr int kMaxMetadataBytes = 8 * 1024;
constexpr int kMaxStreamsPerConnection = 100;
// Only bit 0 (identity): one gzip request of 1 MB was seen to take 1 GB before any handler ran.
constexpr int kIdentityOnly = 1;

void configure(grpc::ServerBuilder& builder) {
  builder.SetMaxReceiveMessageSize(int(kMaxMessageBytes));
  builder.SetMaxSendMessageSize(int(kMaxMessageBytes));
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kMaxStreamsPerConnection);
  builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, kMaxMetadataBytes);
  builder.AddChannelArgument(GRPC_COMPRESSION_CHANNEL_ENABLED_ALGORITHMS_BITSET, kIdentityOnly);
  // A client whose machine has vanished is gone after 20 s; clients may look for us every 10 s.
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 10'000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 10'000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 5'000);
}

}  // namespace

Expected<std::unique_ptr<Door>> Door::open(const api::Context& context, const DoorOptions& options) {
  const std::string& address = options.address;
  grpc::EnableDefaultHealthCheckService(true);
  if (options.reflection) grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  std::unique_ptr<Door> door(new Door);
  grpc::ServerBuilder builder;
  configure(builder);
  builder.AddListeningPort(address, serverCredentials(options.tls), &door->port_);
  door->services_ = makeServices(context);
  for (const auto& service : door->services_) builder.RegisterService(service.get());
  door->server_ = builder.BuildAndStart();
  if (!door->server_ || door->port_ == 0) {
    return Status(Code::kUnavailable, "cannot listen on " + address + ": in use, or not an address of this machine",
                  "listen");
  }
  for (const api::Method& method : api::methods()) {
    const std::string& service = method.descriptor().service()->full_name();
    door->server_->GetHealthCheckService()->SetServingStatus(service, true);
  }
  return door;
}

Door::~Door() = default;

void Door::stopServing() { server_->GetHealthCheckService()->SetServingStatus(false); }

void Door::shutdown(std::chrono::milliseconds patience) {
  server_->Shutdown(std::chrono::system_clock::now() + patience);
  server_->Wait();
}

}  // namespace lpv::grpc_door
