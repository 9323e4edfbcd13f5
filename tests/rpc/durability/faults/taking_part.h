#pragma once
// What writers and readers of a run with faults share: the order of events, their dice, a proxy of their own.

#include <atomic>
#include <chrono>
#include <memory>
#include <random>
#include <string>
#include <thread>

#include "rpc/durability/faults/history.h"
#include "rpc/support/rpc.h"
#include "rpc/support/tcp_proxy.h"

namespace lpv::rpc::faults {

/// Numbers what happens, across threads.
class Moments {
 public:
  Moment next() { return ++last_; }

 private:
  std::atomic<Moment> last_{0};
};

/// Repeatable from its seed.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  /// True once in `n` times.
  bool once(int n) { return between(1, n) == 1; }
  int between(int least, int most) { return std::uniform_int_distribution<int>(least, most)(random_); }
  std::chrono::milliseconds milliseconds(int least, int most) {
    return std::chrono::milliseconds(between(least, most));
  }
  /// Between attempts of a client whose connection broke; between edits of a person.
  void pause(int least, int most) { std::this_thread::sleep_for(milliseconds(least, most)); }
  std::mt19937_64& engine() { return random_; }

 private:
  std::mt19937_64 random_;
};

/// The context of a call that is given up after `patience`: where the server is stopped or the line held, that is how
/// a client gets away.
inline std::unique_ptr<grpc::ClientContext> contextFor(std::chrono::milliseconds patience) {
  auto out = std::make_unique<grpc::ClientContext>();
  out->set_deadline(std::chrono::system_clock::now() + patience);
  return out;
}

/// Who takes part: over a proxy that only it uses.
struct Part {
  std::string session;
  std::uint64_t seed = 0;
  std::uint64_t mostEdits = 0;  ///< of a writer; 0: until it is told to finish
  Moments* moments = nullptr;
  TcpProxy* proxy = nullptr;
};

}  // namespace lpv::rpc::faults
