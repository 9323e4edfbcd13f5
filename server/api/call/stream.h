#pragma once
// The shape of every call, seen from the call driver: messages go in, answers are pulled out. Nothing is queued between
// a door and a session, so a reader that stops costs nothing.

#include <google/protobuf/message.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/mutex.h"
#include "base/status.h"

namespace lpv::api {

/// A call in progress, of whatever messages. CallDriver calls receiveMessage() for each message that arrives,
/// nextMessage() whenever it can write, and cancelled() when the client is gone or may not go on. The stream calls the
/// wake function (any thread, no locks held) when nextMessage() or ended() may have changed.
class AnyStream : public std::enable_shared_from_this<AnyStream> {
 public:
  virtual ~AnyStream() = default;

  /// One message from the client, of the method's request type; its content is moved away. Called one at a time, the
  /// first on a worker thread; later ones may parse and must not wait.
  virtual void receiveMessage(google::protobuf::Message& request) = 0;
  /// Fills the next message to send, of the method's response type; false where there is none now.
  virtual bool nextMessage(google::protobuf::Message* response) = 0;
  /// The client will send no more.
  virtual void halfClosed() {}
  /// False while the door should not read: the client is ahead of us.
  virtual bool wantsRead() { return true; }
  /// True where the call does its work and is answered even when the client has gone or its token was revoked.
  virtual bool completesAnyway() const { return false; }

  /// The client is gone, or may not go on: releases everything and ends with CANCELLED unless it has ended already.
  void cancelled() {
    release();
    end(Status(Code::kCancelled, kClientGone));
  }
  /// How the call ended; asked after nextMessage() has returned false.
  std::optional<Status> ended() {
    const MutexLock lock(endMutex_);
    return ended_;
  }
  void onWake(std::function<void()> wake) {
    const MutexLock lock(endMutex_);
    wake_ = std::move(wake);
  }

  static constexpr const char* kClientGone = "the client went away";

 protected:
  /// Gives up what the call holds. May be called more than once, and while the call is in any state.
  virtual void release() {}

  /// Ends the call from anywhere but next(). The first status wins.
  void end(Status status) {
    endInNext(std::move(status));
    wake();
  }
  /// Ends the call from inside next(): the driver asks ended() by itself, under its lock, and must not be woken.
  void endInNext(Status status) {
    const MutexLock lock(endMutex_);
    if (!ended_) ended_ = std::move(status);
  }
  bool hasEnded() {
    const MutexLock lock(endMutex_);
    return ended_.has_value();
  }
  void wake() {
    std::function<void()> call;
    {
      const MutexLock lock(endMutex_);
      call = wake_;
    }
    if (call) call();
  }

 private:
  Mutex endMutex_;
  std::optional<Status> ended_ LPV_GUARDED_BY(endMutex_);
  std::function<void()> wake_ LPV_GUARDED_BY(endMutex_);
};

/// A call whose messages have types: what AnyStream says of receiveMessage() and nextMessage() holds for receive() and
/// next().
template <typename RequestType, typename ResponseType>
class Stream : public AnyStream {
 public:
  using Request = RequestType;
  using Response = ResponseType;

  virtual void receive(Request request) = 0;
  virtual bool next(Response* response) = 0;

  void receiveMessage(google::protobuf::Message& request) final { receive(std::move(static_cast<Request&>(request))); }
  bool nextMessage(google::protobuf::Message* response) final { return next(static_cast<Response*>(response)); }
};

template <typename Request, typename Response>
using StreamPtr = std::shared_ptr<Stream<Request, Response>>;

/// A Stream that can hand out references to itself: `class Upload final : public StreamOf<Upload, Request, Response>`.
template <typename Self, typename Request, typename Response>
class StreamOf : public Stream<Request, Response> {
 protected:
  std::shared_ptr<Self> me() { return std::static_pointer_cast<Self>(this->shared_from_this()); }
  /// A function that calls `call(Self&, arguments...)` where the stream still lives, and nothing where it does not.
  template <typename Call>
  auto whileAlive(Call call) {
    return [weak = std::weak_ptr<Self>(me()), call = std::move(call)](auto&&... arguments) {
      if (const std::shared_ptr<Self> alive = weak.lock()) {
        call(*alive, std::forward<decltype(arguments)>(arguments)...);
      }
    };
  }
  /// The wake function, for those who outlive the stream.
  auto wakeWhileAlive() {
    return whileAlive([](Self& alive) { alive.wake(); });
  }
};

}  // namespace lpv::api
