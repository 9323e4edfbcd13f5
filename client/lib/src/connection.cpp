#include "connection.h"

#include <grpcpp/security/credentials.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include "lpv/v1/scene.pb.h"

namespace lpv::client {
namespace {

constexpr std::chrono::milliseconds kFirstAttempts(500);  // three or so, by the backoff below

Expected<std::string> readText(const std::string& path, const std::string& what) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return invalid(what, "cannot read the " + what + " file " + path);
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (text.empty()) return invalid(what, "the " + what + " file " + path + " is empty");
  return text;
}

Expected<std::shared_ptr<grpc::ChannelCredentials>> credentials(const TlsOptions& tls) {
  if (!tls.enabled && tls.caFile.empty() && tls.certFile.empty() && tls.keyFile.empty()) {
    return grpc::InsecureChannelCredentials();
  }
  if (tls.certFile.empty() != tls.keyFile.empty()) {
    return invalid("cert", "a client certificate needs its key and the key its certificate; give both or none");
  }
  grpc::SslCredentialsOptions options;
  const std::pair<const std::string*, std::string*> files[] = {{&tls.caFile, &options.pem_root_certs},
                                                               {&tls.certFile, &options.pem_cert_chain},
                                                               {&tls.keyFile, &options.pem_private_key}};
  for (const auto& [path, text] : files) {
    if (path->empty()) continue;
    Expected<std::string> read = readText(*path, path == &tls.caFile ? "ca" : path == &tls.certFile ? "cert" : "key");
    if (!read) return read.status();
    *text = std::move(*read);
  }
  return grpc::SslCredentials(options);
}

grpc::ChannelArguments channelArguments() {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_COMPRESSION_CHANNEL_ENABLED_ALGORITHMS_BITSET,
                   1);  // identity only, like the server
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 5000);  // also the time limit of one attempt
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 2000);
  // A host that vanishes does not close its connections. Pings detect that; streams would reconnect on a dead one.
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 10'000);  // the shortest that gRPC allows
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 5'000);
  return arguments;
}

Code codeFrom(grpc::StatusCode code) {
  // lpvd never answers UNKNOWN; a connection that breaks behind a proxy does.
  if (code == grpc::StatusCode::UNKNOWN) return Code::kUnavailable;
  return static_cast<Code>(code);
}

}  // namespace

Connection::Connection(ConnectOptions given, std::shared_ptr<grpc::Channel> on)
    : options(std::move(given)),
      channel(std::move(on)),
      server(v1::ServerService::NewStub(channel)),
      sessions(v1::SessionService::NewStub(channel)),
      blobs(v1::BlobService::NewStub(channel)),
      scene(v1::SceneService::NewStub(channel)),
      results(v1::ResultService::NewStub(channel)) {}

void Connection::cancel() {
  const std::lock_guard lock(mutex_);
  cancelled_ = true;
  for (grpc::ClientContext* call : calls_) call->TryCancel();
}

bool Connection::cancelled() const {
  const std::lock_guard lock(mutex_);
  return cancelled_;
}

void Connection::reach() {
  std::call_once(reached_, [this] {
    channel->WaitForConnected(std::chrono::system_clock::now() + std::min(kFirstAttempts, options.timeout));
  });
}

Call::Call(Connection& connection, std::chrono::milliseconds extra) : connection_(connection) {
  connection.reach();
  context.set_deadline(std::chrono::system_clock::now() + connection.options.timeout + extra);
  enter();
}

Call::Call(Connection& connection, Stream) : connection_(connection) {
  connection.reach();
  enter();
}

void Call::enter() {
  if (!connection_.options.token.empty()) context.AddMetadata("authorization", "Bearer " + connection_.options.token);
  const std::lock_guard lock(connection_.mutex_);
  connection_.calls_.insert(&context);
  if (connection_.cancelled_) context.TryCancel();
}

Call::~Call() {
  const std::lock_guard lock(connection_.mutex_);
  connection_.calls_.erase(&context);
}

std::chrono::milliseconds timeFor(std::uint64_t bytes) { return std::chrono::milliseconds(bytes / 262); }

Status statusFrom(const grpc::Status& status, const std::string& address) {
  if (status.ok()) return {};
  std::string field;
  Reason reason = Reason::kNone;
  v1::Status details;
  if (details.ParseFromString(status.error_details())) {
    for (const google::protobuf::Any& any : details.details()) {
      v1::FieldViolation violation;
      if (any.UnpackTo(&violation)) field = violation.field();
      v1::ErrorInfo info;
      const bool isInfo = any.type_url() == "type.googleapis.com/google.rpc.ErrorInfo";
      if (isInfo && info.ParseFromString(any.value()) && info.domain() == "lpv.v1") reason = reasonNamed(info.reason());
    }
  }
  const Code code = codeFrom(status.error_code());
  std::string message = status.error_message();
  if (message.empty()) {
    message = code == Code::kUnimplemented ? "the server does not implement this call" : "the server gave no reason";
  }
  if (code == Code::kUnavailable || code == Code::kDeadlineExceeded) message = address + ": " + message;
  return Status(code, reason, std::move(message), std::move(field));
}

bool isRetryable(const grpc::Status& status) {
  switch (status.error_code()) {
    case grpc::StatusCode::OK:  // the server finished a stream that should not end
    case grpc::StatusCode::UNAVAILABLE:
    case grpc::StatusCode::UNKNOWN:
    case grpc::StatusCode::INTERNAL:
    case grpc::StatusCode::CANCELLED:  // by our watchdog; stop() was checked before
      return true;
    default:
      return false;
  }
}

Expected<Client> Client::connect(const ConnectOptions& given) {
  ConnectOptions options = given;
  if (!options.tokenFile.empty()) {
    Expected<std::string> text = readText(options.tokenFile, "token");
    if (!text) return text.status();
    options.token = text->substr(0, text->find_first_of("\r\n"));
  }
  Expected<std::shared_ptr<grpc::ChannelCredentials>> secured = credentials(options.tls);
  if (!secured) return secured.status();
  auto channel = grpc::CreateCustomChannel(options.address, *secured, channelArguments());
  return Client(std::make_shared<Connection>(std::move(options), std::move(channel)));
}

void Client::cancel() { connection_->cancel(); }

const std::string& Client::address() const { return connection_->options.address; }

std::string sessionName(const std::string& idOrName) {
  return idOrName.rfind("sessions/", 0) == 0 ? idOrName : "sessions/" + idOrName;
}

std::string sessionId(const std::string& idOrName) {
  return idOrName.rfind("sessions/", 0) == 0 ? idOrName.substr(9) : idOrName;
}

}  // namespace lpv::client
