#include "gpu/failure.h"

#include <unistd.h>

#include "gpu/gl.h"

namespace lpv::gpu {

void clearErrors() {
  // Bounded, because a lost context may report errors forever.
  for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR; ++i) {
  }
}

void throwOnError(const std::string& what) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  clearErrors();
  if (error == GL_OUT_OF_MEMORY) throw Failure(Code::kResourceExhausted, "GPU memory exhausted: " + what);
  throw Failure(Code::kInternal, "OpenGL error " + std::to_string(error) + ": " + what);
}

void requireMemory(const std::string& what, std::size_t bytes) {
  static const std::size_t most = std::size_t(sysconf(_SC_PHYS_PAGES)) * std::size_t(sysconf(_SC_PAGE_SIZE));
  if (bytes <= most) return;
  throw Failure(Code::kResourceExhausted, "GPU memory exhausted: " + what + ", " + std::to_string(bytes >> 20) +
                                              " MiB, is more than the machine has, " + std::to_string(most >> 20) +
                                              " MiB");
}

void throwOnReset() {
  if (glGetGraphicsResetStatus() != GL_NO_ERROR)
    throw Failure(Code::kUnavailable, "the graphics device was reset; its context is lost");
}

}  // namespace lpv::gpu
