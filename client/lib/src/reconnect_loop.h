#pragma once
// A thread that keeps a stream open: opens it again after a random pause, watches that something arrives.

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "connection.h"

namespace lpv::client {

class ReconnectLoop {
 public:
  struct Behaviour {
    /// Opens the stream, reads it to its end with read() below, returns its status.
    std::function<grpc::Status(grpc::ClientContext&)> attempt;
    std::function<void(const Status&)> reopening;  ///< before each pause; may be empty
    std::function<void(const Status&)> ended;      ///< once, unless stopped; may be empty
  };

  ReconnectLoop(std::shared_ptr<Connection> connection, Behaviour behaviour);
  /// Begins; from here on `behaviour` is called.
  void start();
  ~ReconnectLoop() { stop(); }
  ReconnectLoop(const ReconnectLoop&) = delete;
  ReconnectLoop& operator=(const ReconnectLoop&) = delete;

  /// Reads one message; the watchdog cancels the stream when none comes for 3 s.
  template <typename Stream, typename Message>
  bool read(Stream& stream, Message& message) {
    watch(true);
    const bool got = stream.Read(&message);
    watch(false);
    if (got) alive_ = true;
    return got;
  }

  /// Writes one message before anything is read; the watchdog cancels the stream when it is not taken for 3 s.
  template <typename Stream, typename Message>
  bool write(Stream& stream, const Message& message) {
    watch(true);
    const bool taken = stream.Write(message);
    watch(false);
    return taken;
  }

  /// Ends the stream and, from another thread, waits for the callbacks to be over.
  void stop();
  std::uint64_t reopened() const;

 private:
  using Clock = std::chrono::steady_clock;
  void watch(bool waiting);
  void run();
  void guard();
  grpc::Status attemptOnce();
  bool pause(int failures);

  std::shared_ptr<Connection> connection_;
  Behaviour behaviour_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  bool finished_ = false;                  ///< the reading thread is past its last attempt
  bool waiting_ = false;                   ///< for the other side
  Clock::time_point waitingSince_;
  grpc::ClientContext* context_ = nullptr;
  std::uint64_t attempts_ = 0;
  bool alive_ = false;                     ///< something arrived in this attempt; reading thread only
  std::thread reader_;
  std::thread watchdog_;
};

}  // namespace lpv::client
