// Jobs that wait, and jobs that run meanwhile.

#include "base/worker_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <thread>
#include <vector>

namespace lpv {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Seen to fail (and not to end before its patience) when blockingSection() just waits.
TEST(WorkerPool, OthersRunWhileAJobIsBlocked) {
  WorkerPool pool(1);
  std::promise<void> other;
  std::promise<bool> othersRan;
  pool.post([&] {
    pool.blockingSection(
        [&] { othersRan.set_value(other.get_future().wait_for(seconds(20)) == std::future_status::ready); });
  });
  pool.post([&] { other.set_value(); });
  EXPECT_TRUE(othersRan.get_future().get());
}

// Seen to fail when threads that stood in go on beside those they stood in for.
TEST(WorkerPool, AfterwardsNoMoreRunAtOnceThanBefore) {
  constexpr int kThreads = 2, kBlocked = 5;
  WorkerPool pool(kThreads);
  std::promise<void> over;
  const std::shared_future<void> ended = over.get_future().share();
  std::vector<std::future<void>> blocked;
  for (int i = 0; i < kBlocked; ++i) {
    const auto promise = std::make_shared<std::promise<void>>();
    blocked.push_back(promise->get_future());
    pool.post([&pool, promise, ended] {
      pool.blockingSection([&] { ended.wait(); });
      promise->set_value();
    });
  }
  std::promise<void> reached;  // behind all of them: each is blocked, or waits for its turn to be
  pool.post([&] { reached.set_value(); });
  reached.get_future().wait();
  over.set_value();
  for (const std::future<void>& each : blocked) each.wait();
  std::promise<void> all;
  std::atomic<int> running{0}, most{0}, ran{0};
  for (int i = 0; i < 50; ++i) {
    pool.post([&] {
      const int now = ++running;
      int before = most;
      while (before < now && !most.compare_exchange_weak(before, now)) {
      }
      std::this_thread::sleep_for(milliseconds(1));
      --running;
      if (++ran == 50) all.set_value();
    });
  }
  all.get_future().wait();  // what stop() finds it runs as fast as it can
  EXPECT_LE(most, kThreads);
}

TEST(WorkerPool, ElsewhereWaitingIsWaiting) {
  WorkerPool pool(1);
  bool waited = false;
  pool.blockingSection([&] { waited = true; });
  EXPECT_TRUE(waited);
}

}  // namespace
}  // namespace lpv
