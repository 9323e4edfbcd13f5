#include "gpu/failure.h"

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

void throwOnReset() {
  if (glGetGraphicsResetStatus() != GL_NO_ERROR)
    throw Failure(Code::kUnavailable, "the graphics device was reset; its context is lost");
}

}  // namespace lpv::gpu
