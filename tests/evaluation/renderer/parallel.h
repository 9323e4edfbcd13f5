#pragma once

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

namespace lpv::evaluation {

/// Calls work(i) for every i below `count`, on so many threads, in any order.
inline void parallelFor(int count, int threads, const std::function<void(int)>& work) {
  std::atomic<int> next{0};
  const auto run = [&] {
    for (int i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::thread> pool;
  for (int i = 1; i < threads; ++i) pool.emplace_back(run);
  run();
  for (std::thread& thread : pool) thread.join();
}

}  // namespace lpv::evaluation
