#pragma once
// The shape of every call that is more than question and answer, seen from a door. A door pulls: nothing is queued
// between it and the session, so a reader that stops costs nothing.

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "base/mutex.h"
#include "base/status.h"
#include "base/timers.h"

namespace lpv::api {

/// A call in progress. The door calls receive() for each message that arrives, next() whenever it can write, and
/// cancelled() when its client is gone. The stream calls the door's wake function (any thread, no locks held) when
/// next() or ended() may have changed.
template <typename Request, typename Response>
class Stream : public std::enable_shared_from_this<Stream<Request, Response>> {
 public:
  virtual ~Stream() = default;

  /// One message from the client. Called one at a time; may parse, never waits.
  virtual void receive(Request request) = 0;
  /// The client will send no more.
  virtual void halfClosed() {}
  /// False while the door should not read: the client is ahead of us.
  virtual bool wantsRead() { return true; }
  /// Fills the next message to send; false where there is none now.
  virtual bool next(Response* response) = 0;
  /// The client is gone, or the door is closing: release everything.
  virtual void cancelled() = 0;

  /// How the call ended; asked after next() has returned false.
  std::optional<Status> ended() {
    const MutexLock lock(endMutex_);
    return ended_;
  }
  void onWake(std::function<void()> wake) {
    const MutexLock lock(endMutex_);
    wake_ = std::move(wake);
  }

 protected:
  /// Ends the call from anywhere but next(). The first status wins.
  void end(Status status) {
    endInNext(std::move(status));
    wake();
  }
  /// Ends the call from inside next(): the door asks ended() by itself, under its lock, and must not be woken.
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

}  // namespace lpv::api
