#include "gpu/support/gl_test.h"

#include <iostream>
#include <memory>

namespace lpv::test {

gpu::Context* context(std::string& reason) {
  static std::string why;
  static const std::unique_ptr<gpu::Context> made = [] {
    for (const gpu::Device& device : gpu::preferredOrder(gpu::listDevices())) {
      Expected<gpu::Context> context = gpu::Context::make(device, true);
      if (context.ok()) return std::make_unique<gpu::Context>(std::move(*context));
      why += device.name + ": " + context.status().message() + "; ";
    }
    return std::unique_ptr<gpu::Context>();
  }();
  reason = why;
  return made.get();
}

void GlTest::SetUp() {
  std::string reason;
  if (context(reason) == nullptr) {
    std::cout << "SKIPPED: NO DEVICE (" << reason << ")\n";
    GTEST_SKIP() << reason;
  }
  context(reason)->makeCurrent();
}

void GlTest::TearDown() {
  std::string reason;
  if (context(reason) == nullptr) return;
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

std::vector<glm::vec4> evaluate(const std::string& head, const std::string& body, const std::vector<glm::vec4>& inputs,
                                std::size_t outputs, const gpu::Defines& defines) {
  const std::string count = std::to_string(inputs.size());
  const std::string text = "#include \"layout.h\"\n" + head +
                           "\nlayout(local_size_x = 64) in;\n"
                           "layout(std430, binding = kTestIn) readonly buffer In { vec4 inputs[]; };\n"
                           "layout(std430, binding = kTestOut) writeonly buffer Out { vec4 outputs[]; };\n"
                           "void main() {\n  const uint i = gl_GlobalInvocationID.x;\n  if (i >= " +
                           count + "u) return;\n" + body + "\n}\n";
  gpu::Program program = gpu::Program::computeOfText("test", text, defines);
  const gpu::Buffer in = bufferOf(inputs);
  const gpu::Buffer out("out", (outputs == 0 ? inputs.size() : outputs) * sizeof(glm::vec4));
  in.bindStorage(layout::kTestIn);
  out.bindStorage(layout::kTestOut);
  program.dispatch(std::uint32_t((inputs.size() + 63) / 64));
  gpu::memoryBarrier();
  return read<glm::vec4>(out);
}

}  // namespace lpv::test
