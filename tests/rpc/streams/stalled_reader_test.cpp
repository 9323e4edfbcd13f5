// A reader in a process of its own is stopped (SIGSTOP) while the light moves. The stop lasts 3 s; the environment
// variable LPV_STALL_SECONDS sets another length (10 for the full form).

#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <thread>

#include "lpv/watch.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using Clock = std::chrono::steady_clock;

std::chrono::seconds stallLength() {
  const char* text = std::getenv("LPV_STALL_SECONDS");
  return std::chrono::seconds(text ? std::max(1, std::atoi(text)) : 3);
}

/// Moves the light 20 times a second until destroyed.
class Mover {
 public:
  explicit Mover(std::string session) : session_(std::move(session)), thread_([this] { run(); }) {}
  ~Mover() {
    stopping_ = true;
    thread_.join();
  }
  std::uint64_t revision() const { return revision_; }

 private:
  void run() {
    Stubs own(server().address());
    Clock::time_point next = Clock::now();
    for (int i = 0; !stopping_; ++i) {
      const double x = 0.5 * std::sin(0.1 * i);
      revision_ = apply(own, session_, {moveTo("Lamp", {x, 0, 0})}).revision();
      next += std::chrono::milliseconds(50);
      std::this_thread::sleep_until(next);
    }
  }
  std::string session_;
  std::atomic<std::uint64_t> revision_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

struct Line {
  std::uint64_t revision;
  Clock::time_point when;
};

std::vector<Line> linesOf(const ChildProcess& reader) {
  std::istringstream text(reader.output());
  std::vector<Line> out;
  std::uint64_t revision = 0;
  std::int64_t nanoseconds = 0;
  while (text >> revision >> nanoseconds)
    out.push_back({revision, Clock::time_point(std::chrono::nanoseconds(nanoseconds))});
  return out;
}

TEST(StalledReader, CostsTheServerAndTheOthersNothing) {
  Stubs stubs(server().address());
  const std::string session = makeLitSession(stubs);
  apply(stubs, session, {client::createSurface(surface("Wall", quad(1.0F)))});
  ChildProcess stalled(CHILD_CLIENT_PATH, {server().address(), session, "frames"});
  std::atomic<int> volumes{0};
  client::Client client = clientOf(server().address());
  pb::VolumeSubscription subscription;
  subscription.set_session(session);
  const client::VolumeWatcher other(client, subscription, [&](const client::VolumeResult&) { ++volumes; });
  Mover mover(session);
  ASSERT_TRUE(eventually([&] { return linesOf(stalled).size() >= 10 && volumes >= 10; }));

  const auto ratePerSecond = [&](std::chrono::milliseconds window) {
    const int first = volumes;
    const Clock::time_point from = Clock::now();
    std::this_thread::sleep_for(window);
    return (volumes - first) / std::chrono::duration<double>(Clock::now() - from).count();
  };
  const double before = ratePerSecond(std::chrono::seconds(2));
  const std::int64_t memory = server().residentBytes();
  stalled.signal(SIGSTOP);
  const double during = ratePerSecond(stallLength());
  const std::int64_t growth = server().residentBytes() - memory;
  const std::uint64_t atWake = mover.revision();
  const Clock::time_point wake = Clock::now();
  const std::size_t seen = linesOf(stalled).size();
  stalled.signal(SIGCONT);
  ASSERT_TRUE(eventually([&] { return linesOf(stalled).size() >= seen + 6; }));

  EXPECT_LT(growth, 8 * kMiB * (kSanitized ? 4 : 1)) << "bytes that the server grew by";
  EXPECT_GE(during, 0.7 * before) << "volumes a second of the other reader";
  const std::vector<Line> lines = linesOf(stalled);
  std::vector<std::uint64_t> after;
  for (const Line& line : lines) {
    if (line.when >= wake) after.push_back(line.revision);
  }
  ASSERT_GE(after.size(), 3U);
  // What was under way when it was stopped may still come; the next is made when that is acknowledged.
  EXPECT_GE(after[1], atWake) << "the second result after the wake is older than the wake";
  EXPECT_TRUE(std::is_sorted(after.begin(), after.end()));
  stalled.signal(SIGKILL);
  EXPECT_TRUE(eventually([&] { return getSession(stubs, session).subscriber_count() == 1; }));
}

}  // namespace
}  // namespace lpv::rpc
