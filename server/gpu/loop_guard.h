#pragma once
// llvmpipe ends a thread's loops after 2^16 rounds in all, counts what any of eight neighbours takes, and says nothing:
// light is missing then. With LPV_LOOP_GUARD=1 in the environment every compute program counts the threads that this
// happened to, and says so on stderr when it goes.

#include <cstdint>
#include <string>

namespace lpv::gpu {

/// Counts for one program; move-only; nothing where it is not asked for.
class LoopGuard {
 public:
  LoopGuard() = default;
  explicit LoopGuard(std::string program);
  LoopGuard(LoopGuard&& other) noexcept;
  LoopGuard& operator=(LoopGuard&& other) noexcept;
  ~LoopGuard();

  /// A compute shader's text that counts, where it is asked for; else `text`.
  static std::string guarded(const std::string& text);

  /// Before its program is dispatched.
  void bind() const;
  /// Threads whose loops were ended since it was asked last; waits for them.
  std::uint32_t ended();

 private:
  std::string program_;
  std::uint32_t counter_ = 0;  ///< a buffer; not one of Buffer's, which are counted
};

}  // namespace lpv::gpu
