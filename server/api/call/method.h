#pragma once
// One method of lpv.v1 as the server serves it, and what makes its handler's shape a stream.

#include <google/protobuf/descriptor.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "api/call/context.h"
#include "api/call/stream.h"
#include "base/mutex.h"

namespace lpv::api {

/// Takes how a call ended, once, on any thread; the response is filled by then.
using Done = std::function<void(const Status&)>;

/// The three shapes of handlers: answers at once, on a worker thread; answers later through Done; is a stream.
template <typename Request, typename Response>
using Answer = Status (*)(const Context&, const Request&, Response*);
template <typename Request, typename Response>
using LateAnswer = void (*)(const Context&, const Request&, Response*, Done);
template <typename Request, typename Response>
using OpenStream = StreamPtr<Request, Response> (*)(const Context&);

/// What a handler takes and gives, and how a call of it is opened.
struct Handler {
  const google::protobuf::Message* request = nullptr;  ///< the empty one
  const google::protobuf::Message* response = nullptr;  ///< the empty one
  std::function<std::shared_ptr<AnyStream>(const Context&)> open;
};

/// A row of the method table.
struct Method {
  const char* name;  ///< "SessionService.CreateSession", in lpv.v1
  /// The least that the caller's token has to be good for in the session that the first message names; kAdmin wants the
  /// admin's token, and kViewer without a session any token.
  Role needs;
  /// Path of the first message's field that names the session, as "sessions/{id}" or an id; empty where none does.
  const char* session;
  Handler handler;
  /// Verb of the audit log's line for each success; null: successes are not audited.
  const char* audited = nullptr;
  /// Path of the response's field that names the session that the call made.
  const char* made = "";

  const google::protobuf::MethodDescriptor& descriptor() const;
  /// "CreateSession".
  const std::string& shortName() const { return descriptor().name(); }
  /// "/lpv.v1.SessionService/CreateSession", as HTTP/2 has it.
  std::string path() const;
};

/// The text at `path` ("session.name") in a message; empty where the path is, or where a message on it is not set.
std::string textAt(const google::protobuf::Message& message, const char* path);

/// One question and one answer as a stream. It is carried out even where nobody waits for the answer any longer.
template <typename Request, typename Response>
class QuestionAndAnswer final : public StreamOf<QuestionAndAnswer<Request, Response>, Request, Response> {
 public:
  QuestionAndAnswer(const Context& context, LateAnswer<Request, Response> later, Answer<Request, Response> atOnce)
      : context_(context), later_(later), atOnce_(atOnce) {}

  void receive(Request request) override {
    request_ = std::move(request);
    if (atOnce_) return answer(atOnce_(context_, request_, &response_));
    later_(context_, request_, &response_, [self = this->me()](const Status& status) { self->answer(status); });
  }
  bool next(Response* response) override {
    const MutexLock lock(mutex_);
    if (!answered_) return false;
    answered_ = false;
    response->Swap(&response_);
    return true;
  }
  bool completesAnyway() const override { return true; }

 private:
  void answer(const Status& status) {
    if (!status.ok()) return this->end(status);
    {
      const MutexLock lock(mutex_);
      answered_ = true;
    }
    this->wake();
  }

  const Context context_;
  const LateAnswer<Request, Response> later_;
  const Answer<Request, Response> atOnce_;
  Request request_;
  Response response_;
  Mutex mutex_;
  bool answered_ LPV_GUARDED_BY(mutex_) = false;
};

template <typename Request, typename Response>
Handler handler(Answer<Request, Response> function) {
  return {&Request::default_instance(), &Response::default_instance(), [function](const Context& context) {
            return std::make_shared<QuestionAndAnswer<Request, Response>>(context, nullptr, function);
          }};
}
template <typename Request, typename Response>
Handler handler(LateAnswer<Request, Response> function) {
  return {&Request::default_instance(), &Response::default_instance(), [function](const Context& context) {
            return std::make_shared<QuestionAndAnswer<Request, Response>>(context, function, nullptr);
          }};
}
template <typename Request, typename Response>
Handler handler(OpenStream<Request, Response> open) {
  return {&Request::default_instance(), &Response::default_instance(), open};
}

}  // namespace lpv::api
