#include "gpu/debug.h"

#include <spdlog/spdlog.h>

#include <string_view>

#include "gpu/gl.h"

namespace lpv::gpu {

namespace {

spdlog::level::level_enum levelOf(GLenum type, GLenum severity) {
  if (type == GL_DEBUG_TYPE_ERROR) return spdlog::level::err;
  if (severity == GL_DEBUG_SEVERITY_HIGH) return spdlog::level::warn;
  return spdlog::level::debug;
}

void APIENTRY onMessage(GLenum, GLenum type, GLuint id, GLenum severity, GLsizei length, const GLchar* text,
                        const void*) {
  const std::string_view message = length < 0 ? std::string_view(text) : std::string_view(text, std::size_t(length));
  spdlog::log(levelOf(type, severity), "OpenGL {}: {}", id, message);
}

}  // namespace

void installDebugOutput(bool verbose) {
  glEnable(GL_DEBUG_OUTPUT);
  glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DONT_CARE, 0, nullptr, verbose ? GL_TRUE : GL_FALSE);
  glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DEBUG_SEVERITY_NOTIFICATION, 0, nullptr, GL_FALSE);
  glDebugMessageControl(GL_DONT_CARE, GL_DEBUG_TYPE_ERROR, GL_DONT_CARE, 0, nullptr, GL_TRUE);
  if (verbose) glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(onMessage, nullptr);
}

}  // namespace lpv::gpu
