#include "gpu/fence.h"

#include <utility>

#include "gpu/gl.h"

namespace lpv::gpu {

namespace {
GLsync syncOf(void* sync) { return static_cast<GLsync>(sync); }
}  // namespace

Fence Fence::insert() {
  Fence fence;
  fence.sync_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  glFlush();
  return fence;
}

Fence::Fence(Fence&& other) noexcept : sync_(std::exchange(other.sync_, nullptr)) {}

Fence& Fence::operator=(Fence&& other) noexcept {
  Fence taken(std::move(other));
  std::swap(sync_, taken.sync_);
  return *this;
}

Fence::~Fence() {
  if (sync_ != nullptr) glDeleteSync(syncOf(sync_));
}

bool Fence::signalled() const { return wait(std::chrono::microseconds(0)); }

bool Fence::wait(std::chrono::microseconds atMost) const {
  if (sync_ == nullptr) return true;
  const auto nanoseconds = std::chrono::nanoseconds(atMost).count();
  // A lost context returns GL_WAIT_FAILED: treat it as signalled; the reset check reports the reason.
  return glClientWaitSync(syncOf(sync_), 0, GLuint64(nanoseconds)) != GL_TIMEOUT_EXPIRED;
}

}  // namespace lpv::gpu
