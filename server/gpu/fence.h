#pragma once

#include <chrono>

namespace lpv::gpu {

/// A point in the command stream. Made after the commands it stands for; flushes them. Move-only; empty after move.
class Fence {
 public:
  Fence() = default;
  static Fence insert();
  Fence(Fence&& other) noexcept;
  Fence& operator=(Fence&& other) noexcept;
  ~Fence();

  explicit operator bool() const { return sync_ != nullptr; }
  /// Whether everything before it is done; never waits. An empty fence is signalled.
  bool signalled() const;
  /// Waits at most this long; the same answer.
  bool wait(std::chrono::microseconds atMost) const;

 private:
  void* sync_ = nullptr;
};

}  // namespace lpv::gpu
