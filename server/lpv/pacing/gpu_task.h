#pragma once
// Coroutines that give the GPU back between bounded pieces of work. A stage is a function returning GpuTask: it queues
// GL commands, says `co_yield submitted(...)`, and goes on when its turn comes again; it never waits for the GPU
// itself, `co_yield waitFor(fence)` lets others work meanwhile. One stage runs another with `co_await`.

#include <chrono>
#include <coroutine>
#include <exception>
#include <utility>

#include "engine/stage.h"
#include "gpu/fence.h"
#include "lpv/pacing/frame_pool.h"

namespace lpv {

/// Why a coroutine paused.
struct Pause {
  enum class Kind { kPiece, kYield, kFence } kind = Kind::kPiece;
  Stage stage = Stage::kUpload;       ///< kPiece: what the commands since the last pause belong to
  double units = 1.0;                 ///< kPiece: how much was done, in the stage's own unit (StageClock)
  const gpu::Fence* fence = nullptr;  ///< kFence: what to wait for; outlives the wait
};

/// A bounded piece of `stage` has been queued.
inline Pause submitted(Stage stage, double units = 1.0) { return {Pause::Kind::kPiece, stage, units, nullptr}; }

/// Others may have their turn; what was done since the last pause belongs to no stage, or keeps this thread more than
/// it keeps the GPU.
inline Pause yield() { return {Pause::Kind::kYield, Stage::kUpload, 0.0, nullptr}; }

/// Nothing more can be done before `fence` has signalled.
inline Pause waitFor(const gpu::Fence& fence) { return {Pause::Kind::kFence, Stage::kReadback, 0.0, &fence}; }

/// A lazily started coroutine of pieces. Move-only; destroying it abandons the rest.
class [[nodiscard]] GpuTask {
 public:
  struct promise_type;
  using Handle = std::coroutine_handle<promise_type>;

  struct promise_type {
    /// Frames of coroutines are used again and again: a tick has hundreds, of few sizes.
    static void* operator new(std::size_t bytes) { return frames().take(bytes); }
    static void operator delete(void* frame, std::size_t bytes) noexcept { frames().giveBack(frame, bytes); }

    promise_type* root = this;      ///< the outermost coroutine, which the engine resumes
    Handle leaf;                    ///< root only: the innermost one, where to go on
    Pause pause;                    ///< root only: why it stands
    std::coroutine_handle<> parent; ///< who awaits this one
    std::exception_ptr error;

    GpuTask get_return_object() {
      leaf = Handle::from_promise(*this);
      return GpuTask(leaf);
    }
    std::suspend_always initial_suspend() noexcept { return {}; }
    std::suspend_always yield_value(const Pause& p) noexcept {
      root->pause = p;
      return {};
    }
    void return_void() noexcept {}
    void unhandled_exception() noexcept { error = std::current_exception(); }

    struct BackToParent {
      bool await_ready() noexcept { return false; }
      std::coroutine_handle<> await_suspend(Handle self) noexcept {
        promise_type& promise = self.promise();
        if (!promise.parent) return std::noop_coroutine();
        promise.root->leaf = Handle::from_address(promise.parent.address());
        return promise.parent;
      }
      void await_resume() noexcept {}
    };
    BackToParent final_suspend() noexcept { return {}; }
  };

  GpuTask(GpuTask&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  GpuTask& operator=(GpuTask&& other) noexcept {
    GpuTask taken(std::move(other));
    std::swap(handle_, taken.handle_);
    return *this;
  }
  ~GpuTask() {
    if (handle_) handle_.destroy();
  }

  bool done() const { return handle_.done(); }
  /// Runs to the next pause; throws what the coroutine threw.
  void resume() {
    handle_.promise().leaf.resume();
    if (handle_.done() && handle_.promise().error) std::rethrow_exception(handle_.promise().error);
  }
  /// Why it stands; valid after resume() while not done().
  const Pause& pause() const { return handle_.promise().pause; }

  /// Runs all of it on this thread, waiting for what it waits for: where nobody else uses the device (tests, benches).
  void runToEnd() {
    while (!done()) {
      resume();
      if (done() || pause().kind != Pause::Kind::kFence) continue;
      while (!pause().fence->wait(std::chrono::milliseconds(100))) {
      }
    }
  }

  struct Awaiter {
    Handle child;
    bool await_ready() const noexcept { return child.done(); }
    Handle await_suspend(Handle parent) noexcept {
      promise_type& promise = child.promise();
      promise.root = parent.promise().root;
      promise.parent = parent;
      promise.root->leaf = child;
      return child;
    }
    void await_resume() const {
      if (child.promise().error) std::rethrow_exception(child.promise().error);
    }
  };
  /// Runs this coroutine's pieces as pieces of the awaiting one.
  Awaiter operator co_await() const& noexcept { return {handle_}; }

 private:
  /// Of this thread.
  static FramePool& frames() {
    static thread_local FramePool pool;
    return pool;
  }

  explicit GpuTask(Handle handle) : handle_(handle) {}
  Handle handle_;
};

}  // namespace lpv
