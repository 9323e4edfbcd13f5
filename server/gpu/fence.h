#pragma once

#include <chrono>

namespace lpv::gpu {

/// A point in the command stream, after the commands queued before its construction; flushes them. Move-only; empty
/// after move.
class Fence {
 public:
  Fence() = default;
  static Fence insert();
  Fence(Fence&& other) noexcept;
  Fence& operator=(Fence&& other) noexcept;
  ~Fence();

  explicit operator bool() const { return sync_ != nullptr; }
  /// True if all commands before it have finished; never waits. An empty fence is signalled.
  bool signalled() const;
  /// The same, waiting at most this long.
  bool wait(std::chrono::microseconds atMost) const;

 private:
  void* sync_ = nullptr;
};

}  // namespace lpv::gpu
