#pragma once
// A streaming call as a door drives it (api/call/call_driver.h): the first message before anything else, later ones on
// one thread, answers pulled on whichever thread wakes, cancellation whenever it comes.

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "api/call/stream.h"

namespace lpv::test {

template <typename Request, typename Response>
class Guest : public std::enable_shared_from_this<Guest<Request, Response>> {
 public:
  /// What the client says to an answer; nothing where it says nothing. Called on any thread, one call at a time.
  using React = std::function<std::optional<Request>(const Response&)>;

  static std::shared_ptr<Guest> open(std::shared_ptr<api::Stream<Request, Response>> stream, Request first,
                                     React react) {
    const std::shared_ptr<Guest> guest(new Guest(std::move(stream), std::move(react)));
    guest->stream_->onWake([weak = std::weak_ptr<Guest>(guest)] {
      if (const auto self = weak.lock()) self->pump();
    });
    guest->stream_->receive(std::move(first));
    {
      const std::lock_guard lock(guest->mutex_);
      guest->opening_ = false;
    }
    guest->reader_ = std::thread([raw = guest.get()] { raw->read(); });
    guest->pump();
    return guest;
  }

  void say(Request request) {
    {
      const std::lock_guard lock(mutex_);
      said_.push_back(std::move(request));
    }
    changed_.notify_all();
  }
  /// Waits until so many answers have come, or the call has ended; says how many came.
  int await(int answers) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return answers_ >= answers || end_; });
    return answers_;
  }
  /// How the call ended; waits.
  Status end() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return end_.has_value(); });
    return *end_;
  }
  /// The client sends no more.
  void finish() {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
    changed_.notify_all();
  }
  void cancel() {
    stream_->cancelled();
    pump();
  }
  /// Before it goes: on the thread that opened it.
  void leave() {
    cancel();
    {
      const std::lock_guard lock(mutex_);
      leaving_ = true;
    }
    changed_.notify_all();
    reader_.join();
  }

 private:
  Guest(std::shared_ptr<api::Stream<Request, Response>> stream, React react)
      : stream_(std::move(stream)), react_(std::move(react)) {}

  void pump() {
    const std::lock_guard lock(mutex_);
    if (opening_ || end_) return;
    Response response;
    while (stream_->next(&response)) {
      ++answers_;
      if (std::optional<Request> reply = react_(response)) said_.push_back(std::move(*reply));
      response.Clear();
    }
    end_ = stream_->ended();
    changed_.notify_all();
  }

  void read() {
    std::unique_lock lock(mutex_);
    bool closed = false;
    while (true) {
      changed_.wait(lock, [&] { return leaving_ || !said_.empty() || (finishing_ && !closed); });
      if (leaving_) return;
      if (said_.empty()) {
        closed = true;
        lock.unlock();
        stream_->halfClosed();
        pump();
        lock.lock();
        continue;
      }
      Request request = std::move(said_.front());
      said_.pop_front();
      lock.unlock();
      while (!stream_->wantsRead() && !stream_->ended()) std::this_thread::yield();
      stream_->receive(std::move(request));
      lock.lock();
    }
  }

  const std::shared_ptr<api::Stream<Request, Response>> stream_;
  const React react_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Request> said_;
  std::optional<Status> end_;
  int answers_ = 0;
  bool opening_ = true;
  bool finishing_ = false;
  bool leaving_ = false;
  std::thread reader_;
};

}  // namespace lpv::test
