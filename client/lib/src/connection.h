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

/// Largest message in either direction, and the payload of an upload's part, which leaves room for its other fields.
inline constexpr std::size_t kMaxMessageBytes = std::size_t(1) << 20U;
inline constexpr std::size_t kPartBytes = kMaxMessageBytes - 4096;

class Connection {
 public:
  Connection(ConnectOptions options, std::shared_ptr<grpc::Channel> channel);

  /// Cancels all Calls, those in flight and later ones.
  void cancel();
  bool cancelled() const;

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

/// Converts a call's status, with the field of its FieldViolation if the server named one.
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
