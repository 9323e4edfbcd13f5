#pragma once
// api::Stream on gRPC's callback API. Each reactor keeps itself alive until OnDone; the stream wakes it through a weak
// reference. Rules kept here and nowhere else: one write in flight, Finish exactly once and only when nothing is being
// written, no Start* after Finish. Start* and Finish are called under the reactor's lock: reactions never run inside
// them, gRPC hands them to its own threads.
//
// A stream's first message goes to a worker: the session that it names may have to come back from disk. Nothing else
// happens to the stream meanwhile.

#include <grpcpp/grpcpp.h>
#include <grpcpp/support/server_callback.h>

#include <memory>
#include <optional>
#include <utility>

#include "api/call/context.h"
#include "api/call/stream.h"
#include "api/services.h"
#include "base/mutex.h"
#include "grpc/admission.h"
#include "grpc/finish.h"

namespace lpv::door {

using api::StreamPtr;

/// A stream behind a reactor of any of gRPC's four kinds. Requests are read where `Base` reads, else there is one,
/// given at the start; responses are written where `Base` writes, else there is one, whose place is given at the start.
template <typename Base, typename Request, typename Response>
class StreamReactor final : public Base {
 public:
  static Base* start(const api::Context& context, grpc::CallbackServerContext* call,
                     StreamPtr<Request, Response> stream, const Request* request, Response* response) {
    auto* reactor = new StreamReactor(context, contextOf(*call, {}), std::move(stream), response);
    reactor->self_.reset(reactor);
    reactor->tokenWatch_ =
        context.access->watch(context.caller, [weak = std::weak_ptr<StreamReactor>(reactor->self_)](const Status& why) {
          if (const auto self = weak.lock()) self->revokeAccess(why);
        });
    reactor->stream_->onWake([weak = std::weak_ptr<StreamReactor>(reactor->self_)] {
      if (const auto self = weak.lock()) self->pump();
    });
    if (request) reactor->open(*request);
    reactor->pump();
    return reactor;
  }

  // gRPC's reactions. They override those that `Base` has, which "override" could not say.
  // NOLINTBEGIN(modernize-use-override)
  void OnReadDone(bool ok) {
    if (ok && !opened_) return open(std::move(request_));
    if (ok) {
      stream_->receive(std::move(request_));
      request_.Clear();
    } else {
      stream_->halfClosed();
    }
    {
      const MutexLock lock(mutex_);
      reading_ = false;
      inputEnded_ = !ok;
    }
    pump();
  }

  void OnWriteDone(bool ok) {
    {
      const MutexLock lock(mutex_);
      writing_ = false;
      broken_ = broken_ || !ok;
    }
    pump();
  }

  void OnCancel() {
    {
      const MutexLock lock(mutex_);
      broken_ = true;
      if (opening_) return;
    }
    stream_->cancelled();
    pump();
  }

  void OnDone() {
    stream_->cancelled();
    self_.reset();
  }
  // NOLINTEND(modernize-use-override)

 private:
  static constexpr bool kReads = requires(Base& base, Request* request) { base.StartRead(request); };
  static constexpr bool kWrites = requires(Base& base, const Response* response) { base.StartWrite(response); };

  StreamReactor(const api::Context& context, ops::LogContext who, StreamPtr<Request, Response> stream,
                Response* response)
      : context_(context),
        who_(std::move(who)),
        stream_(std::move(stream)),
        response_(response ? response : &ownResponse_) {}

  /// Hands the first message to a worker.
  void open(Request request) {
    opened_ = true;
    ops::LogContext who;
    {
      const MutexLock lock(mutex_);
      opening_ = true;
      who_.session = shortId(sessionIn(request));
      who = who_;
    }
    context_.pool->post([self = self_, who = std::move(who), request = std::move(request)]() mutable {
      const ops::LogScope scope(std::move(who));
      self->stream_->receive(std::move(request));
      bool cancelled = false;
      {
        const MutexLock lock(self->mutex_);
        self->opening_ = false;
        self->reading_ = false;
        cancelled = self->broken_ || self->expelled_;
      }
      if (cancelled) self->stream_->cancelled();
      self->pump();
    });
  }

  /// The token that opened the stream is no longer good.
  void revokeAccess(const Status& why) {
    {
      const MutexLock lock(mutex_);
      expelled_ = why;
      if (opening_) return;
    }
    stream_->cancelled();
    pump();
  }

  /// Starts whatever can be started now.
  void pump() {
    const MutexLock lock(mutex_);
    if (finished_ || opening_) return;
    if (!writing_ && !broken_ && !expelled_) respond();
    if (!writing_) {
      if (const std::optional<Status> end = ending()) {
        finished_ = true;
        const ops::LogScope scope(who_);
        this->Finish(finish<Request>(context_, *response_, *end, written_));
        return;
      }
    }
    if constexpr (kReads) {
      if (reading_ || inputEnded_ || !stream_->wantsRead()) return;
      reading_ = true;
      this->StartRead(&request_);
    }
  }

  void respond() LPV_REQUIRES(mutex_) {
    response_->Clear();
    if (!stream_->next(response_)) return;
    if constexpr (kWrites) {
      writing_ = written_ = true;
      this->StartWrite(response_);
    } else {
      answered_ = true;
    }
  }

  std::optional<Status> ending() LPV_REQUIRES(mutex_) {
    if (broken_) return Status(Code::kCancelled, "the client went away");
    if (expelled_) return expelled_;
    if (answered_) return Status();
    return stream_->ended();
  }

  const api::Context context_;
  ops::LogContext who_ LPV_GUARDED_BY(mutex_);
  StreamPtr<Request, Response> stream_;
  std::shared_ptr<StreamReactor> self_;
  Mutex mutex_;
  Request request_;
  Response ownResponse_;
  Response* response_;
  bool opened_ = false;  ///< the first message has come
  bool opening_ LPV_GUARDED_BY(mutex_) = false;  ///< a worker has it
  bool reading_ LPV_GUARDED_BY(mutex_) = false;
  bool writing_ LPV_GUARDED_BY(mutex_) = false;
  bool written_ LPV_GUARDED_BY(mutex_) = false;  ///< something
  bool inputEnded_ LPV_GUARDED_BY(mutex_) = false;
  bool broken_ LPV_GUARDED_BY(mutex_) = false;
  bool answered_ LPV_GUARDED_BY(mutex_) = false;  ///< the one response is in its place
  bool finished_ LPV_GUARDED_BY(mutex_) = false;
  std::optional<Status> expelled_ LPV_GUARDED_BY(mutex_);  ///< why, once it is
  std::shared_ptr<void> tokenWatch_;  ///< tells when that is so
};

/// A call that is refused at the door.
template <typename Base>
class Refusal final : public Base {
 public:
  explicit Refusal(const grpc::Status& why) { this->Finish(why); }
  void OnDone() override { delete this; }
};

template <typename Base, typename Request, typename Response>
Base* refuse(const api::Context& context, const grpc::CallbackServerContext& call, const Status& why) {
  const ops::LogScope scope(contextOf(call, {}));
  return new Refusal<Base>(finish<Request>(context, Response(), why));
}

/// What makes a stream of the service for a caller.
template <typename Request, typename Response>
using MakeStream = StreamPtr<Request, Response> (*)(const api::Context&);

template <typename Base, typename Request, typename Response>
Base* admit(const api::Context& context, grpc::CallbackServerContext* call, MakeStream<Request, Response> make,
            const Request* request, Response* response) {
  const Expected<api::Context> admitted = admit(context, *call);
  if (!admitted) return refuse<Base, Request, Response>(context, *call, admitted.status());
  return StreamReactor<Base, Request, Response>::start(*admitted, call, make(*admitted), request, response);
}

/// Both sides stream.
template <typename Request, typename Response>
grpc::ServerBidiReactor<Request, Response>* serve(const api::Context& context, grpc::CallbackServerContext* call,
                                                  MakeStream<Request, Response> make) {
  return admit<grpc::ServerBidiReactor<Request, Response>, Request, Response>(context, call, make, nullptr, nullptr);
}

/// One question, many answers.
template <typename Request, typename Response>
grpc::ServerWriteReactor<Response>* serve(const api::Context& context, grpc::CallbackServerContext* call,
                                          MakeStream<Request, Response> make, const Request* request) {
  return admit<grpc::ServerWriteReactor<Response>, Request, Response>(context, call, make, request, nullptr);
}

/// Many messages, one answer.
template <typename Request, typename Response>
grpc::ServerReadReactor<Request>* serve(const api::Context& context, grpc::CallbackServerContext* call,
                                        MakeStream<Request, Response> make, Response* response) {
  return admit<grpc::ServerReadReactor<Request>, Request, Response>(context, call, make, nullptr, response);
}

/// One question, one answer that has to be waited for.
template <typename Request, typename Response>
grpc::ServerUnaryReactor* serve(const api::Context& context, grpc::CallbackServerContext* call,
                                MakeStream<Request, Response> make, const Request* request, Response* response) {
  return admit<grpc::ServerUnaryReactor, Request, Response>(context, call, make, request, response);
}

/// One question, one answer, computed by `function` on a worker thread: no reaction blocks.
template <typename Request, typename Response>
grpc::ServerUnaryReactor* answer(const api::Context& context, grpc::CallbackServerContext* call, const Request* request,
                                 Response* response,
                                 Status (*function)(const api::Context&, const Request&, Response*)) {
  Expected<api::Context> admitted = admit(context, *call);
  if (!admitted) return refuse<grpc::ServerUnaryReactor, Request, Response>(context, *call, admitted.status());
  grpc::ServerUnaryReactor* reactor = call->DefaultReactor();
  context.pool->post([own = std::move(*admitted), call, request, response, reactor, function] {
    const ops::LogScope scope(contextOf(*call, sessionIn(*request)));
    reactor->Finish(finish<Request>(own, *response, function(own, *request, response)));
  });
  return reactor;
}

/// The same, answered when `function` says so.
template <typename Request, typename Response>
grpc::ServerUnaryReactor* answer(const api::Context& context, grpc::CallbackServerContext* call, const Request* request,
                                 Response* response,
                                 void (*function)(const api::Context&, const Request&, Response*, api::Done)) {
  Expected<api::Context> admitted = admit(context, *call);
  if (!admitted) return refuse<grpc::ServerUnaryReactor, Request, Response>(context, *call, admitted.status());
  grpc::ServerUnaryReactor* reactor = call->DefaultReactor();
  context.pool->post([&context, own = std::move(*admitted), call, request, response, reactor, function] {
    const ops::LogContext who = contextOf(*call, sessionIn(*request));
    const ops::LogScope scope(who);
    function(own, *request, response, [&context, who, response, reactor](const Status& status) {
      const ops::LogScope ending(who);
      reactor->Finish(finish<Request>(context, *response, status));
    });
  });
  return reactor;
}

}  // namespace lpv::door
