#include "web/calls.h"

#include <atomic>
#include <chrono>
#include <deque>
#include <optional>
#include <utility>

#include "api/call/address_limit.h"
#include "api/call/call_driver.h"
#include "api/call/connections.h"
#include "api/call/deadline.h"
#include "api/call/method_table.h"
#include "base/text.h"
#include "convert/scene.h"
#include "session/access.h"

namespace lpv::web_door {
namespace {

using google::protobuf::Message;
using web::v1::ToClient;
using web::v1::ToServer;

/// The method that a page calls "lpv.v1.SceneService/EditScene"; null where there is none.
const api::Method* methodNamed(const std::string& name) {
  static const std::map<std::string, const api::Method*> kByName = [] {
    std::map<std::string, const api::Method*> out;
    for (const api::Method& method : api::methods()) out[method.path().substr(1)] = &method;
    return out;
  }();
  const auto found = kByName.find(name);
  return found == kByName.end() ? nullptr : found->second;
}

ToClient endOf(std::uint32_t id, const Status& status) {
  ToClient out;
  out.set_call(id);
  if (status.ok()) {
    out.mutable_end();
  } else {
    api::toProto(status, out.mutable_end());
  }
  return out;
}

}  // namespace

/// One call: the driver's transport. What the driver asks for is done in a later turn of the socket.
class Calls::Call final : public api::Transport, public std::enable_shared_from_this<Call> {
 public:
  Call(std::shared_ptr<Calls> calls, std::uint32_t id, const api::Method& method)
      : calls_(std::move(calls)),
        socket_(calls_->socket_),
        id_(id),
        clientStreams_(method.descriptor().client_streaming()),
        peer_(calls_->peer_),
        deadline_(*calls_->server_.timers) {}

  void start(const api::Method& method, const web::v1::Begin& begin) {
    driver_ = std::make_shared<api::CallDriver>(calls_->server_, method,
                                                api::CallOrigin{.token = calls_->token_,
                                                                .peer = peer_,
                                                                .traceparent = begin.traceparent(),
                                                                .hasDeadline = begin.timeout_ms() != 0},
                                                *this);
    if (begin.timeout_ms() != 0) {
      deadline_.restart(std::chrono::milliseconds(begin.timeout_ms()), [weak = weak_from_this()] {
        if (const auto self = weak.lock()) self->later([](Call& call) { call.expire(); });
      });
    }
    driver_->start();
  }

  // From the page.
  void message(std::string bytes) {
    if (inputEnded_ || finished_) return;
    if (!clientStreams_ && received_ > 0) return;  // it was told all that it needs
    if (inbox_.size() >= kMostUntaken) {
      socket_->close(CloseCode::kPolicy, "message: a call may have 8 messages that the server has not said taken of");
      return;
    }
    ++received_;
    calls_->counted(bytes.size(), 0);
    inbox_.push_back(std::move(bytes));
    hand();
  }
  void end() {
    inputEnded_ = true;
    hand();
  }
  void cancel() { driver_->onCancel(); }

  // From the driver, on any thread.
  void read(Message* into) override {
    later([into](Call& call) {
      call.wanted_ = into;
      call.hand();
    });
  }
  void write(const Message& message) override {
    later([bytes = message.SerializeAsString()](Call& call) mutable {
      call.put(std::move(bytes), [self = call.shared_from_this()](bool ok) { self->driver_->onWrite(ok); });
    });
  }
  void finish(const Message* last, const Status& status) override {
    std::optional<std::string> bytes;
    if (last != nullptr) bytes = last->SerializeAsString();
    later([bytes = std::move(bytes), status](Call& call) mutable { call.close(std::move(bytes), status); });
  }
  void dropPeer() override { api::shutDownConnectionsFrom(api::addressOf(peer_)); }

 private:
  template <typename Job>
  void later(Job job) {
    socket_->post([self = shared_from_this(), job = std::move(job)]() mutable { job(*self); });
  }

  void expire() {
    expired_ = true;
    driver_->onCancel();
  }

  void put(std::string bytes, std::function<void(bool)> sent) {
    ToClient step;
    step.set_call(id_);
    step.set_message(std::move(bytes));
    calls_->say(step, std::move(sent));
  }

  /// Gives the driver what it waits for, where that is there.
  void hand() {
    if (wanted_ == nullptr || finished_) return;
    if (inbox_.empty()) {
      const bool noMore = inputEnded_ || (!clientStreams_ && received_ > 0);
      if (!noMore) return;
      wanted_ = nullptr;
      return driver_->onRead(api::ReadResult::kEnd);
    }
    const std::string bytes = std::move(inbox_.front());
    inbox_.pop_front();
    const bool parsed = std::exchange(wanted_, nullptr)->ParseFromString(bytes);
    ToClient step;
    step.set_call(id_);
    step.set_taken(1);
    calls_->say(step);
    calls_->counted(0, bytes.size());
    driver_->onRead(parsed ? api::ReadResult::kMessage : api::ReadResult::kMalformed);
  }

  void close(std::optional<std::string> last, const Status& status) {
    finished_ = true;
    deadline_.stop();
    std::size_t left = 0;
    for (const std::string& bytes : inbox_) left += bytes.size();
    inbox_.clear();
    calls_->counted(0, left);
    if (last) put(std::move(*last), [](bool) {});
    const bool late = expired_ && status.code() == Code::kCancelled;
    const Status told =
        late ? Status(Code::kDeadlineExceeded, "the call's timeout_ms has passed", "timeout_ms") : status;
    calls_->say(endOf(id_, told), [self = shared_from_this()](bool) {
      self->driver_->onDone();
      self->calls_->forget(self->id_);
    });
  }

  const std::shared_ptr<Calls> calls_;
  const std::shared_ptr<Socket> socket_;
  const std::uint32_t id_;
  const bool clientStreams_;
  const std::string peer_;
  api::Deadline deadline_;
  std::shared_ptr<api::CallDriver> driver_;
  std::deque<std::string> inbox_;  ///< not taken
  std::size_t received_ = 0;
  bool inputEnded_ = false;
  bool expired_ = false;
  bool finished_ = false;
  Message* wanted_ = nullptr;  ///< the driver's read in progress
};

Calls::Calls(const api::Context& server, std::string peer, std::shared_ptr<Socket> socket)
    : server_(server), peer_(std::move(peer)), socket_(std::move(socket)) {}

Calls::~Calls() = default;

void Calls::receive(std::string_view bytes) {
  if (!socket_) return;
  ToServer step;
  if (!step.ParseFromArray(bytes.data(), int(bytes.size()))) {
    return socket_->close(CloseCode::kNotAMessage, "the bytes are no lpv.web.v1.ToServer");
  }
  const std::uint32_t id = step.call();
  switch (step.step_case()) {
    case ToServer::STEP_NOT_SET:
      return socket_->close(CloseCode::kPolicy, "step: is not set; a ToServer has one");
    case ToServer::kHello:
      return hello(step.hello().token());
    default:
      break;
  }
  if (!helloCame_) return socket_->close(CloseCode::kPolicy, "hello: must be the socket's first message");
  if (step.has_begin()) return begin(id, step.begin());
  if (id > last_) {
    return socket_->close(CloseCode::kPolicy, "call: " + std::to_string(id) + " has not begun; send begin first");
  }
  // A call that has ended here may not have ended there yet.
  if (const auto found = calls_.find(id); found != calls_.end()) pass(*std::shared_ptr<Call>(found->second), step);
}

void Calls::hello(const std::string& token) {
  token_ = token;
  helloCame_ = true;
  // First: whoever reads the welcome no longer has a place among strangers, whose next socket may need it.
  socket_->greeted(!server_.access->required() || server_.access->verify(token).ok());
  ToClient welcome;
  welcome.mutable_welcome()->set_version(server_.version);
  say(welcome);
}

void Calls::begin(std::uint32_t id, const web::v1::Begin& begin) {
  if (id <= last_) {
    return socket_->close(CloseCode::kPolicy,
                          "call: " + std::to_string(id) + " is no new number; the latest was " + std::to_string(last_));
  }
  last_ = id;
  const api::Method* method = methodNamed(begin.method());
  if (method == nullptr) {
    return refuse(id, Status(Code::kUnimplemented,
                             "\"" + truncatedUtf8(begin.method()) +
                                 "\" is no method of this server; \"lpv.v1.SceneService/EditScene\" is one",
                             "method"));
  }
  if (calls_.size() >= kMostCalls) {
    return refuse(id, exhausted("call", "a socket may have 100 calls at once; end some before others begin")
                          .retriedAfter(std::chrono::seconds(1)));
  }
  const auto call = std::make_shared<Call>(shared_from_this(), id, *method);
  calls_[id] = call;
  call->start(*method, begin);
}

void Calls::pass(Call& call, ToServer& step) {
  switch (step.step_case()) {
    case ToServer::kMessage:
      return call.message(std::move(*step.mutable_message()));
    case ToServer::kEnd:
      return call.end();
    default:
      return call.cancel();
  }
}

void Calls::refuse(std::uint32_t id, const Status& status) { say(endOf(id, status)); }

void Calls::say(const ToClient& step, std::function<void(bool)> sent) {
  if (socket_) return socket_->send(step.SerializeAsString(), std::move(sent));
  sent(false);
}

void Calls::counted(std::size_t came, std::size_t went) {
  untakenBytes_ += came;
  untakenBytes_ -= went;
  if (untakenBytes_ >= kMostUntakenBytes) full_ = true;
  if (!full_ || untakenBytes_ >= kMostUntakenBytes / 2) return;
  full_ = false;
  if (socket_) socket_->roomAgain();
}

void Calls::lost() {
  socket_.reset();
  for (const auto& [id, call] : std::map(calls_)) call->cancel();
}

void Calls::forget(std::uint32_t id) { calls_.erase(id); }

}  // namespace lpv::web_door
