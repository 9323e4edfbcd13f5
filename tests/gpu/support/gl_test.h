#pragma once
// Tests that speak OpenGL themselves, on the test's own thread.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <span>
#include <string>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/context.h"
#include "gpu/gl.h"
#include "gpu/program.h"
#include "shaders/layout.h"

namespace lpv::test {

/// The first device's debug context, made once and current from then on; null, with the reason, where there is none.
gpu::Context* context(std::string& reason);

/// Skips every test, saying why, where there is no device. A test that leaves a GL error behind fails.
class GlTest : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;
};

/// The content of a buffer.
template <typename T>
std::vector<T> read(const gpu::Buffer& buffer) {
  std::vector<T> values(buffer.size() / sizeof(T));
  glFinish();
  glGetNamedBufferSubData(buffer.id(), 0, GLsizeiptr(values.size() * sizeof(T)), values.data());
  return values;
}

template <typename T>
gpu::Buffer bufferOf(const std::vector<T>& values) {
  return {"test", gpu::bytesOf(std::span<const T>(values)), gpu::BufferUse::kDynamic};
}

/// Runs `body`, GLSL statements that read in[i] and write out[i] (vec4 arrays) for i = gl_GlobalInvocationID.x < count,
/// after `head` (includes, functions); returns what was written, one vec4 per input unless `outputs` says otherwise.
std::vector<glm::vec4> evaluate(const std::string& head, const std::string& body, const std::vector<glm::vec4>& inputs,
                                std::size_t outputs = 0, const gpu::Defines& defines = {});

}  // namespace lpv::test
