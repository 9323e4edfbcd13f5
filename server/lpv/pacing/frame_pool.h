#pragma once

#include <array>
#include <cstddef>
#include <new>

namespace lpv {

/// Memory of coroutines that have ended, kept for the next of about the same size. Not thread-safe: each thread has its
/// own; what another thread has taken may be given back here.
class FramePool {
 public:
  FramePool() = default;
  FramePool(const FramePool&) = delete;
  FramePool& operator=(const FramePool&) = delete;
  ~FramePool() {
    for (Free*& list : free_) {
      while (list != nullptr) {
        Free* const first = list;
        list = first->next;
        ::operator delete(first);
      }
    }
  }

  void* take(std::size_t bytes) {
    const std::size_t step = stepOf(bytes);
    if (step >= kSteps) return ::operator new(bytes);
    Free* const first = free_[step];
    if (first == nullptr) return ::operator new((step + 1) * kStep);
    free_[step] = first->next;
    return first;
  }

  void giveBack(void* frame, std::size_t bytes) noexcept {
    const std::size_t step = stepOf(bytes);
    if (step >= kSteps) return ::operator delete(frame);
    free_[step] = new (frame) Free{free_[step]};
  }

 private:
  struct Free {
    Free* next;
  };
  static constexpr std::size_t kStep = 128;  ///< bytes from one size to the next
  static constexpr std::size_t kSteps = 32;  ///< larger ones are not kept
  static std::size_t stepOf(std::size_t bytes) { return (bytes - 1) / kStep; }

  std::array<Free*, kSteps> free_{};
};

}  // namespace lpv
