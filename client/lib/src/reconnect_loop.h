#pragma once
// A thread that keeps a stream open: it reconnects after a random pause, and when nothing arrives for 3 s.

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
    /// Opens the stream, reads it to its end with read(), returns its status.
    std::function<grpc::Status(grpc::ClientContext&)> attempt;
    std::function<void(const Status&)> reopening;  ///< called before each pause; may be empty
    std::function<void(const Status&)> ended;      ///< called once, unless stop() ended the loop; may be empty
  };

  ReconnectLoop(std::shared_ptr<Connection> connection, Behaviour behaviour);
  /// Starts the threads, which call `behaviour`.
  void start();
  ~ReconnectLoop() { stop(); }
  ReconnectLoop(const ReconnectLoop&) = delete;
  ReconnectLoop& operator=(const ReconnectLoop&) = delete;

  /// Reads one message. The watchdog cancels the stream if none arrives for 3 s.
  template <typename Stream, typename Message>
  bool read(Stream& stream, Message& message) {
    watch(true);
    const bool got = stream.Read(&message);
    watch(false);
    if (got) alive_ = true;
    return got;
  }

  /// Writes a message before reading begins. The watchdog cancels the stream if the write takes 3 s.
  template <typename Stream, typename Message>
  bool write(Stream& stream, const Message& message) {
    watch(true);
    const bool taken = stream.Write(message);
    watch(false);
    return taken;
  }

  /// Ends the stream. Waits for running callbacks unless called from one.
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
  bool finished_ = false;                  ///< the reading thread has made its last attempt
  bool waiting_ = false;                   ///< a read or write is in progress
  Clock::time_point waitingSince_;
  grpc::ClientContext* context_ = nullptr;
  std::uint64_t attempts_ = 0;
  bool alive_ = false;                     ///< a message arrived in this attempt; reading thread only
  std::thread reader_;
  std::thread watchdog_;
};

}  // namespace lpv::client
