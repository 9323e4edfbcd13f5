#include "grpc/door.h"

#include <grpc/grpc.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/impl/server_builder_option.h>
#include <grpcpp/server_builder.h>

#include <utility>

#include "grpc/call.h"
#include "grpc/library_log.h"
#include "session/limits.h"
#include "wire/message_size.h"

namespace lpv::grpc_door {
namespace {

constexpr int kMaxMetadataBytes = 8 * 1024;
constexpr int kMaxStreamsPerConnection = 100;
// Only bit 0 (identity): one gzip request of 1 MB was seen to take 1 GB before any handler ran.
constexpr int kIdentityOnly = 1;

void configure(grpc::ServerBuilder& builder) {
  builder.SetMaxReceiveMessageSize(int(wire::kMaxMessageBytes));
  builder.SetMaxSendMessageSize(int(wire::kMaxMessageBytes));
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

/// Takes back what the reflection library has done when it was loaded.
class NoReflection final : public grpc::ServerBuilderOption {
 public:
  void UpdateArguments(grpc::ChannelArguments*) override {}
  void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override {
    std::erase_if(*plugins, [](const auto& plugin) { return plugin->name() == "proto_server_reflection"; });
  }
};

void reflect(grpc::ServerBuilder& builder, bool wanted) {
  if (!wanted) builder.SetOption(std::make_unique<NoReflection>());
}

}  // namespace

Expected<std::unique_ptr<Door>> Door::open(const api::Context& context, const DoorOptions& options) {
  Expected<std::unique_ptr<api::Listener>> listener = api::Listener::bind("listen", options.address);
  if (!listener) return listener.status();
  takeLibraryLog();
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();  // once; the library may have done so
  std::unique_ptr<Door> door(new Door);
  door->listener_ = std::move(*listener);
  std::shared_ptr<grpc::ServerCredentials> credentials = grpc::InsecureServerCredentials();
  if (options.certificates) {
    Expected<std::unique_ptr<Certificates>> certificates = Certificates::of(*options.certificates);
    if (!certificates) return certificates.status();
    door->certificates_ = std::move(*certificates);
    credentials = door->certificates_->credentials();
  }
  grpc::ServerBuilder builder;
  configure(builder);
  reflect(builder, options.reflection);
  using From = grpc::ServerBuilder::experimental_type::ExternalConnectionType;
  auto acceptor = builder.experimental().AddExternalConnectionAcceptor(From::FROM_FD, credentials);
  door->services_ = makeServices(context);
  for (const auto& service : door->services_) builder.RegisterService(service.get());
  door->server_ = builder.BuildAndStart();
  if (!door->server_) return Status(Code::kInternal, "gRPC's server on " + options.address + " cannot be started");
  for (const api::Method& method : api::methods()) {
    const std::string& service = method.descriptor().service()->full_name();
    door->server_->GetHealthCheckService()->SetServingStatus(service, true);
  }
  door->listener_->start(context.addresses, [acceptor = std::shared_ptr(std::move(acceptor))](int listening, int file) {
    grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
    connection.listener_fd = listening;
    connection.fd = file;
    acceptor->HandleNewConnection(&connection);
  });
  return door;
}

Door::~Door() = default;

int Door::port() const { return listener_->port(); }

void Door::stopServing() { server_->GetHealthCheckService()->SetServingStatus(false); }

void Door::shutdown(std::chrono::milliseconds patience) {
  listener_->stop();
  server_->Shutdown(std::chrono::system_clock::now() + patience);
  server_->Wait();
}

}  // namespace lpv::grpc_door
