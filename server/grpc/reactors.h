#pragma once
// api::Stream on gRPC's callback API. Each reactor keeps itself alive until OnDone; the stream wakes it through a weak
// reference. Rules kept here and nowhere else: one write in flight, Finish exactly once and only when nothing is being
// written, no Start* after Finish. Start* and Finish are called under the reactor's lock: reactions never run inside
// them, gRPC hands them to its own threads.

#include <grpcpp/grpcpp.h>
#include <grpcpp/support/server_callback.h>

#include <memory>
#include <mutex>
#include <utility>

#include "api/context.h"
#include "api/stream.h"
#include "grpc/status.h"

namespace lpv::door {

template <typename Request, typename Response>
using StreamPtr = std::shared_ptr<api::Stream<Request, Response>>;

/// Both sides stream.
template <typename Request, typename Response>
class BidiReactor final : public grpc::ServerBidiReactor<Request, Response> {
 public:
  static grpc::ServerBidiReactor<Request, Response>* start(StreamPtr<Request, Response> stream) {
    auto* reactor = new BidiReactor(std::move(stream));
    reactor->self_.reset(reactor);
    reactor->stream_->onWake([weak = std::weak_ptr<BidiReactor>(reactor->self_)] {
      if (const auto self = weak.lock()) self->pump();
    });
    reactor->pump();
    return reactor;
  }

  void OnReadDone(bool ok) override {
    if (ok) {
      stream_->receive(std::move(request_));
      request_.Clear();
    } else {
      stream_->halfClosed();
    }
    {
      const std::lock_guard lock(mutex_);
      reading_ = false;
      inputEnded_ = !ok;
    }
    pump();
  }

  void OnWriteDone(bool ok) override {
    {
      const std::lock_guard lock(mutex_);
      writing_ = false;
      broken_ = broken_ || !ok;
    }
    pump();
  }

  void OnCancel() override {
    stream_->cancelled();
    {
      const std::lock_guard lock(mutex_);
      broken_ = true;
    }
    pump();
  }

  void OnDone() override {
    stream_->cancelled();
    self_.reset();
  }

 private:
  explicit BidiReactor(StreamPtr<Request, Response> stream) : stream_(std::move(stream)) {}

  /// Starts whatever can be started now.
  void pump() {
    const std::lock_guard lock(mutex_);
    if (finished_) return;
    if (!writing_ && !broken_) {
      response_.Clear();
      if (stream_->next(&response_)) {
        writing_ = true;
        this->StartWrite(&response_);
      }
    }
    if (!writing_) {
      const std::optional<Status> end = broken_ ? Status(Code::kCancelled, "the client went away") : stream_->ended();
      if (end) {
        finished_ = true;
        this->Finish(toGrpc(*end));
        return;
      }
    }
    if (!reading_ && !inputEnded_ && stream_->wantsRead()) {
      reading_ = true;
      this->StartRead(&request_);
    }
  }

  StreamPtr<Request, Response> stream_;
  std::shared_ptr<BidiReactor> self_;
  std::mutex mutex_;
  Request request_;
  Response response_;
  bool reading_ = false;
  bool writing_ = false;
  bool inputEnded_ = false;
  bool broken_ = false;
  bool finished_ = false;
};

/// One question, many answers.
template <typename Request, typename Response>
class WriteReactor final : public grpc::ServerWriteReactor<Response> {
 public:
  static grpc::ServerWriteReactor<Response>* start(StreamPtr<Request, Response> stream, const Request& request) {
    auto* reactor = new WriteReactor(std::move(stream));
    reactor->self_.reset(reactor);
    reactor->stream_->onWake([weak = std::weak_ptr<WriteReactor>(reactor->self_)] {
      if (const auto self = weak.lock()) self->pump();
    });
    reactor->stream_->receive(request);
    reactor->pump();
    return reactor;
  }

  void OnWriteDone(bool ok) override {
    {
      const std::lock_guard lock(mutex_);
      writing_ = false;
      broken_ = broken_ || !ok;
    }
    pump();
  }

  void OnCancel() override {
    stream_->cancelled();
    {
      const std::lock_guard lock(mutex_);
      broken_ = true;
    }
    pump();
  }

  void OnDone() override {
    stream_->cancelled();
    self_.reset();
  }

 private:
  explicit WriteReactor(StreamPtr<Request, Response> stream) : stream_(std::move(stream)) {}

  void pump() {
    const std::lock_guard lock(mutex_);
    if (finished_ || writing_) return;
    if (!broken_) {
      response_.Clear();
      if (stream_->next(&response_)) {
        writing_ = true;
        this->StartWrite(&response_);
        return;
      }
    }
    const std::optional<Status> end = broken_ ? Status(Code::kCancelled, "the client went away") : stream_->ended();
    if (!end) return;
    finished_ = true;
    this->Finish(toGrpc(*end));
  }

  StreamPtr<Request, Response> stream_;
  std::shared_ptr<WriteReactor> self_;
  std::mutex mutex_;
  Response response_;
  bool writing_ = false;
  bool broken_ = false;
  bool finished_ = false;
};

/// Many messages, one answer.
template <typename Request, typename Response>
class ReadReactor final : public grpc::ServerReadReactor<Request> {
 public:
  static grpc::ServerReadReactor<Request>* start(StreamPtr<Request, Response> stream, Response* response) {
    auto* reactor = new ReadReactor(std::move(stream), response);
    reactor->self_.reset(reactor);
    reactor->stream_->onWake([weak = std::weak_ptr<ReadReactor>(reactor->self_)] {
      if (const auto self = weak.lock()) self->pump();
    });
    reactor->pump();
    return reactor;
  }

  void OnReadDone(bool ok) override {
    if (ok) {
      stream_->receive(std::move(request_));
      request_.Clear();
    } else {
      stream_->halfClosed();
    }
    {
      const std::lock_guard lock(mutex_);
      reading_ = false;
      inputEnded_ = !ok;
    }
    pump();
  }

  void OnCancel() override {
    stream_->cancelled();
    pump();
  }

  void OnDone() override {
    stream_->cancelled();
    self_.reset();
  }

 private:
  ReadReactor(StreamPtr<Request, Response> stream, Response* response)
      : stream_(std::move(stream)), response_(response) {}

  void pump() {
    const std::lock_guard lock(mutex_);
    if (finished_) return;
    if (const std::optional<Status> end = stream_->ended()) {
      if (end->ok()) stream_->next(response_);
      finished_ = true;
      this->Finish(toGrpc(*end));
      return;
    }
    if (!reading_ && !inputEnded_ && stream_->wantsRead()) {
      reading_ = true;
      this->StartRead(&request_);
    }
  }

  StreamPtr<Request, Response> stream_;
  Response* response_;
  std::shared_ptr<ReadReactor> self_;
  std::mutex mutex_;
  Request request_;
  bool reading_ = false;
  bool inputEnded_ = false;
  bool finished_ = false;
};

/// One question, one answer that has to be waited for.
template <typename Request, typename Response>
class AwaitReactor final : public grpc::ServerUnaryReactor {
 public:
  static grpc::ServerUnaryReactor* start(StreamPtr<Request, Response> stream, const Request& request,
                                         Response* response) {
    auto* reactor = new AwaitReactor(std::move(stream), response);
    reactor->self_.reset(reactor);
    reactor->stream_->onWake([weak = std::weak_ptr<AwaitReactor>(reactor->self_)] {
      if (const auto self = weak.lock()) self->pump();
    });
    reactor->stream_->receive(request);
    reactor->pump();
    return reactor;
  }

  void OnCancel() override {
    stream_->cancelled();
    pump();
  }

  void OnDone() override {
    stream_->cancelled();
    self_.reset();
  }

 private:
  AwaitReactor(StreamPtr<Request, Response> stream, Response* response)
      : stream_(std::move(stream)), response_(response) {}

  void pump() {
    const std::lock_guard lock(mutex_);
    if (finished_) return;
    const bool answered = stream_->next(response_);
    const std::optional<Status> end = answered ? Status() : stream_->ended();
    if (!end) return;
    finished_ = true;
    this->Finish(toGrpc(*end));
  }

  StreamPtr<Request, Response> stream_;
  Response* response_;
  std::shared_ptr<AwaitReactor> self_;
  std::mutex mutex_;
  bool finished_ = false;
};

/// One question, one answer, computed by `call` on a worker thread: no reaction blocks.
template <typename Request, typename Response>
grpc::ServerUnaryReactor* answer(api::Context& context, grpc::CallbackServerContext* call, const Request* request,
                                 Response* response, Status (*function)(api::Context&, const Request&, Response*)) {
  grpc::ServerUnaryReactor* reactor = call->DefaultReactor();
  context.pool->post([&context, request, response, reactor, function] {
    reactor->Finish(toGrpc(function(context, *request, response)));
  });
  return reactor;
}

}  // namespace lpv::door
