#pragma once
// A TCP proxy of the tests' own between clients and a server on the loopback: delays, holds, cuts.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace lpv::rpc {

/// Listens on a free port until destroyed. Thread-safe.
class TcpProxy {
 public:
  /// Leads to 127.0.0.1:`target`. Throws std::runtime_error where it cannot listen.
  explicit TcpProxy(int target);
  ~TcpProxy();
  TcpProxy(const TcpProxy&) = delete;
  TcpProxy& operator=(const TcpProxy&) = delete;

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  /// Connections to come lead there; 0: nowhere, they are closed at once.
  void setTarget(int port);
  /// Each byte arrives this much later, in each direction.
  void setDelay(std::chrono::milliseconds oneWay);
  /// Answers go no faster than so many bytes a second, each connection's by itself; 0: as fast as they can.
  void setAnswerRate(double bytesPerSecond);
  /// While true nothing arrives in that direction; once a little has piled up, the sender is no longer read.
  void holdRequests(bool hold);
  void holdAnswers(bool hold);
  /// Resets every connection; what was on its way is lost.
  void cut();
  /// Every connection there is leads nowhere from now on, and neither end is told: a machine that has vanished.
  void lose();

 private:
  /// Bytes on their way.
  struct Chunk {
    std::chrono::steady_clock::time_point due;
    std::string bytes;
    std::size_t sent = 0;
  };
  /// One direction of a connection.
  struct Lane {
    int from = -1;
    int to = -1;
    std::deque<Chunk> chunks;
    std::size_t size = 0;     ///< bytes in chunks
    std::chrono::steady_clock::time_point freeAt{};  ///< when the line has taken them all, where it has a rate
    bool ended = false;       ///< the sender said that no more comes
    bool passedOn = false;    ///< and the receiver was told
  };
  struct Connection {
    Lane requests;
    Lane answers;
    bool broken = false;
  };
  struct Settings {
    int target = 0;
    std::chrono::milliseconds delay{0};
    double answerRate = 0.0;
    bool holdRequests = false;
    bool holdAnswers = false;
    bool cut = false;
    bool lose = false;
    bool stopping = false;
  };

  Settings take();
  template <typename Change>
  void change(Change how);
  void run();
  void accept(const Settings& settings);
  void wait(const Settings& settings);
  void move(Connection& connection, const Settings& settings);
  static void close(Connection& connection, bool reset);

  int listener_ = -1;
  int wake_ = -1;  ///< eventfd
  int port_ = 0;
  std::mutex mutex_;
  Settings settings_;
  std::list<Connection> connections_;  ///< the thread's own
  std::list<Connection> lost_;         ///< its own too; nobody reads them
  std::thread thread_;
};

}  // namespace lpv::rpc
