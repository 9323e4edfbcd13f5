#include "grpc/call.h"

#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/impl/codegen/server_callback_handlers.h>
#include <grpcpp/support/server_callback.h>

#include <chrono>
#include <deque>
#include <iterator>
#include <string>
#include <utility>

#include "api/call/address_limit.h"
#include "api/call/call_driver.h"
#include "api/call/connections.h"
#include "grpc/status.h"

namespace lpv::grpc_door {
namespace {

using google::protobuf::Message;
using Bytes = grpc::ByteBuffer;
using Reactor = grpc::ServerBidiReactor<Bytes, Bytes>;

/// The value of a header that is given once. W3C Trace Context, section 3.2.1: two of them are as good as none.
Expected<std::string> header(const grpc::CallbackServerContext& call, const char* name) {
  const auto [first, last] = call.client_metadata().equal_range(name);
  if (first == last) return std::string();
  if (std::next(first) != last) return Status(Code::kInvalidArgument, "given more than once", name);
  return std::string(first->second.data(), first->second.size());
}

/// The token of "authorization: Bearer TOKEN"; empty for none.
Expected<std::string> shownToken(const grpc::CallbackServerContext& call) {
  constexpr const char* kHeader = "authorization";
  constexpr std::string_view kScheme = "Bearer ";
  const Expected<std::string> text = header(call, kHeader);
  if (text && text->empty() && !call.client_metadata().contains(kHeader)) return std::string();
  if (text && text->starts_with(kScheme)) return text->substr(kScheme.size());
  return Status(Code::kUnauthenticated, "authorization is given more than once, or is not of the form \"Bearer TOKEN\"",
                kHeader);
}

/// A deadline further away than this is none.
constexpr std::chrono::hours kFarAway{24};

bool hasDeadline(const grpc::CallbackServerContext& call) {
  return call.deadline() < std::chrono::system_clock::now() + kFarAway;
}

api::CallOrigin originOf(const grpc::CallbackServerContext& call) {
  const Expected<std::string> traceparent = header(call, "traceparent");
  return {.token = shownToken(call),
          .peer = call.peer(),
          .traceparent = traceparent ? *traceparent : std::string(),
          .hasDeadline = hasDeadline(call)};
}

/// One call on gRPC's callback API, which answers Start* and Finish on threads of its own, never from inside them.
/// Lives until OnDone.
class Call final : public Reactor, public api::Transport {
 public:
  static Reactor* start(const api::Context& context, const api::Method& method, grpc::CallbackServerContext* call) {
    auto* made = new Call;
    made->self_.reset(made);
    made->peer_ = call->peer();
    made->driver_ = std::make_shared<api::CallDriver>(context, method, originOf(*call), *made);
    made->driver_->start();
    return made;
  }

  void read(Message* into) override {
    into_ = into;
    StartRead(&in_);
  }
  void write(const Message& message) override {
    pack(message);
    StartWrite(&out_);
  }
  void finish(const Message* last, const Status& status) override {
    if (last == nullptr) return Finish(toGrpc(status));
    pack(*last);
    StartWriteAndFinish(&out_, grpc::WriteOptions(), toGrpc(status));
  }
  void dropPeer() override { api::shutDownConnectionsFrom(api::addressOf(peer_)); }

  void OnReadDone(bool ok) override {
    using api::ReadResult;
    if (!ok) return driver_->onRead(ReadResult::kEnd);
    const bool parsed = grpc::SerializationTraits<Message>::Deserialize(&in_, into_).ok();
    driver_->onRead(parsed ? ReadResult::kMessage : ReadResult::kMalformed);
  }
  void OnWriteDone(bool ok) override { driver_->onWrite(ok); }
  void OnCancel() override { driver_->onCancel(); }
  void OnDone() override {
    driver_->onDone();
    self_.reset();
  }

 private:
  void pack(const Message& message) {
    bool own = false;
    out_.Clear();
    (void)grpc::SerializationTraits<Message>::Serialize(message, &out_, &own);
  }

  std::unique_ptr<Call> self_;
  std::string peer_;
  std::shared_ptr<api::CallDriver> driver_;
  Message* into_ = nullptr;
  Bytes in_;
  Bytes out_;
};

/// One service of the table. Every method is registered as if both sides streamed: what that means on the wire is the
/// same, and the call driver knows how many messages each side sends.
class Service final : public grpc::Service {
 public:
  explicit Service(const api::Context& context) : context_(context) {}

  void add(const api::Method& method) {
    using grpc::internal::RpcMethod;
    const std::string& path = paths_.emplace_back(method.path());
    AddMethod(new grpc::internal::RpcServiceMethod(path.c_str(), RpcMethod::BIDI_STREAMING, nullptr));
    MarkMethodRawCallback(int(paths_.size()) - 1, new grpc::internal::CallbackBidiHandler<Bytes, Bytes>(
                                                      [this, &method](grpc::CallbackServerContext* call) {
                                                        return Call::start(context_, method, call);
                                                      }));
  }

 private:
  const api::Context& context_;
  std::deque<std::string> paths_;  ///< gRPC keeps pointers into them
};

}  // namespace

std::vector<std::unique_ptr<grpc::Service>> makeServices(const api::Context& context) {
  std::vector<std::unique_ptr<grpc::Service>> services;
  const google::protobuf::ServiceDescriptor* last = nullptr;
  Service* service = nullptr;
  for (const api::Method& method : api::methods()) {
    if (method.descriptor().service() != last) {
      last = method.descriptor().service();
      auto made = std::make_unique<Service>(context);
      service = made.get();
      services.push_back(std::move(made));
    }
    service->add(method);
  }
  return services;
}

}  // namespace lpv::grpc_door
