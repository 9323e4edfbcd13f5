#include "gpu/shader_source.h"

#include "gpu/failure.h"
#include "gpu/support/gl_test.h"

namespace lpv {
namespace {

class ShaderSourceTest : public test::GlTest {};

TEST(ShaderSourceTextTest, PutsDefinesFirstAndEveryIncludeOnce) {
  const gpu::Defines before = gpu::defineForDevice({{"OF_THE_DEVICE", "2"}});
  const gpu::ShaderSource source =
      gpu::assembleText("t", "#include \"common/sh.glsl\"\n#include \"common/sh.glsl\"\nint a;\n", {{"X", "1"}});
  gpu::defineForDevice(before);
  EXPECT_THAT(source.text, testing::StartsWith("#version 450 core\n#define OF_THE_DEVICE 2\n#define X 1\n"));
  EXPECT_THAT(source.files, testing::ElementsAre("t", "common/sh.glsl"));
  EXPECT_NE(source.text.find("shLobe"), std::string::npos);
  EXPECT_EQ(source.text.find("vec4 shLobe"), source.text.rfind("vec4 shLobe"));
}

TEST(ShaderSourceTextTest, MissingFileIsAFailureByName) {
  try {
    gpu::assembleShader("no_such.comp", {});
    FAIL();
  } catch (const gpu::Failure& failure) {
    EXPECT_THAT(failure.status().message(), testing::HasSubstr("no_such.comp"));
  }
}

// Broken by: leaving out the #line after an include.
TEST_F(ShaderSourceTest, CompilerMessagesNameFileAndLine) {
  try {
    gpu::Program::computeOfText(
        "t", "#include \"common/sh.glsl\"\nlayout(local_size_x = 1) in;\nvoid main() { wrong(); }\n", {});
    FAIL();
  } catch (const gpu::Failure& failure) {
    EXPECT_EQ(failure.status().code(), Code::kInternal);
    EXPECT_THAT(failure.status().message(), testing::ContainsRegex("0.3"));
    EXPECT_THAT(failure.status().message(), testing::HasSubstr("0 = t"));
  }
}

// Broken by: a variant whose #error is missing.
TEST_F(ShaderSourceTest, VariantsWithoutTheirDefinesDoNotCompile) {
  for (const char* file : {"voxelize/voxelize.comp", "transport/inject.comp", "transport/propagate.comp",
                           "transport/volume.comp", "frame/exposure.comp", "frame/near_field.comp"})
    EXPECT_THROW(gpu::Program({file}, {{"LPV_CHANNELS", "1"}}), gpu::Failure) << file;
}

}  // namespace
}  // namespace lpv
