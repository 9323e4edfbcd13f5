#pragma once
// One channel, its stubs, and the calls in flight on it.

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "lpv/client.h"
#include "lpv/v1/blob.grpc.pb.h"
#include "lpv/v1/result.grpc.pb.h"
#include "lpv/v1/scene.grpc.pb.h"
#include "lpv/v1/server.grpc.pb.h"
#include "lpv/v1/session.grpc.pb.h"

namespace lpv::client {

class Connection {
 public:
  Connection(ConnectOptions options, std::shared_ptr<grpc::Channel> channel);

  /// Cancels all Calls, those in flight and later ones.
  void cancel();
  bool cancelled() const;
  /// Lets the first attempts to connect be more than one: gRPC 1.51 may take one that is under way for one that failed
  /// (grpc/grpc pull request 35064), and a server may be about to listen. Once; returns with or without a connection.
  void reach();

  const ConnectOptions options;
  const std::shared_ptr<grpc::Channel> channel;
  const std::unique_ptr<v1::ServerService::Stub> server;
  const std::unique_ptr<v1::SessionService::Stub> sessions;
  const std::unique_ptr<v1::BlobService::Stub> blobs;
  const std::unique_ptr<v1::SceneService::Stub> scene;
  const std::unique_ptr<v1::ResultService::Stub> results;

 private:
  friend class Call;
  mutable std::mutex mutex_;
  std::set<grpc::ClientContext*> calls_;
  bool cancelled_ = false;
  std::once_flag reached_;
};

/// The context of one call, with authorization and deadline set. Connection::cancel cancels it while it lives.
class Call {
 public:
  /// A unary call with the connection's timeout plus `extra`.
  explicit Call(Connection& connection, std::chrono::milliseconds extra = std::chrono::milliseconds(0));
  /// A stream, without a deadline.
  struct Stream {};
  Call(Connection& connection, Stream);
  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  grpc::ClientContext context;

 private:
  void enter();
  Connection& connection_;
};

/// Extra time for an upload of this size: 1 s per 256 KiB.
std::chrono::milliseconds timeFor(std::uint64_t bytes);

/// Converts a call's status, with the field of its FieldViolation and the reason of its ErrorInfo if the server named
/// them.
Status statusFrom(const grpc::Status& status, const std::string& address);

/// True if reconnecting the stream can cure this status.
bool isRetryable(const grpc::Status& status);

/// Makes one unary call; `method` is a member of a stub.
template <typename Response, typename Stub, typename Request>
Expected<Response> unary(Connection& connection, Stub& stub,
                         grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                         const Request& request) {
  Call call(connection);
  Response response;
  const grpc::Status status = (stub.*method)(&call.context, request, &response);
  if (!status.ok()) return statusFrom(status, connection.options.address);
  return response;
}

}  // namespace lpv::client
