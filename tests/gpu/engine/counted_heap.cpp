#include "gpu/engine/counted_heap.h"

#include <execinfo.h>
#include <unistd.h>

#include <cstdlib>
#include <new>
#include <utility>

extern "C" const char __executable_start, etext;  // the linker's: this program's code

namespace {

thread_local bool counting = false;
thread_local std::size_t taken = 0;

/// Where it is taken, on standard error, for those who look for what takes: LPV_HEAP_TRACE=1.
void trace() {
  static const bool asked = std::getenv("LPV_HEAP_TRACE") != nullptr;
  if (!asked) return;
  counting = false;
  void* frames[12];
  backtrace_symbols_fd(frames, backtrace(frames, 12), 2);
  const ssize_t written = write(2, "\n", 1);
  (void)written;
  counting = true;
}

/// Whether the caller is in this program, not in a driver.
bool isOurs(const void* caller) {
  return caller >= static_cast<const void*>(&__executable_start) && caller < static_cast<const void*>(&etext);
}

void* take(std::size_t bytes, std::size_t alignment, const void* caller) {
  if (counting && isOurs(caller)) {
    ++taken;
    trace();
  }
  const std::size_t least = bytes == 0 ? 1 : bytes;
  void* place = alignment <= alignof(std::max_align_t)
                    ? std::malloc(least)
                    : std::aligned_alloc(alignment, (least + alignment - 1) / alignment * alignment);
  if (place == nullptr) throw std::bad_alloc();
  return place;
}

}  // namespace

void* operator new(std::size_t bytes) { return take(bytes, 1, __builtin_return_address(0)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return take(bytes, std::size_t(alignment), __builtin_return_address(0));
}
void operator delete(void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t) noexcept { std::free(place); }
void operator delete(void* place, std::align_val_t) noexcept { std::free(place); }
void operator delete(void* place, std::size_t, std::align_val_t) noexcept { std::free(place); }

namespace lpv::test {

void countHeap() {
  taken = 0;
  counting = true;
}

std::size_t countedHeap() {
  counting = false;
  return std::exchange(taken, 0);
}

}  // namespace lpv::test
