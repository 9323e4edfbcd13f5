// GL objects: what a failed allocation, a move and a readback do.

#include <cstring>

#include "gpu/buffer_texture.h"
#include "gpu/failure.h"
#include "gpu/fence.h"
#include "gpu/framebuffer.h"
#include "gpu/readback.h"
#include "gpu/support/gl_test.h"
#include "gpu/texture.h"

namespace lpv {
namespace {

class ObjectsTest : public test::GlTest {};

template <typename Make>
Code codeOf(Make make) {
  try {
    make();
  } catch (const gpu::Failure& failure) {
    return failure.status().code();
  }
  return Code::kOk;
}

// Broken by: no throwOnError in createStorage.
TEST_F(ObjectsTest, TooLargeAllocationsAreFailuresNotCrashes) {
  EXPECT_EQ(codeOf([] { gpu::Buffer("huge", std::size_t(1) << 42); }), Code::kResourceExhausted);
  EXPECT_EQ(codeOf([] { gpu::Readback("huge", std::size_t(1) << 42); }), Code::kResourceExhausted);
  EXPECT_NE(codeOf([] { gpu::Texture::make3d("huge", glm::ivec3(1 << 20), GL_RGBA32F, gpu::Sampling::kLinearClamp); }),
            Code::kOk);
}

TEST_F(ObjectsTest, NewBuffersAreZero) {
  EXPECT_THAT(test::read<std::uint32_t>(gpu::Buffer("zero", 4096)), testing::Each(0U));
}

// On a driver that clears late the zeros would come last.
TEST_F(ObjectsTest, WhatIsWrittenIntoANewBufferStays) {
  for (const std::size_t words : {1000, 25000, 300000}) {
    const std::vector<std::uint32_t> values(words, 7U);
    gpu::Buffer buffer("written at once", words * sizeof(std::uint32_t), gpu::BufferUse::kDynamic);
    buffer.update(0, gpu::bytesOf(std::span<const std::uint32_t>(values)));
    EXPECT_EQ(test::read<std::uint32_t>(buffer), values);
  }
}

// Broken by: moves that copy the id.
TEST_F(ObjectsTest, MovedFromIsEmpty) {
  gpu::Buffer a("a", 16);
  gpu::Buffer b = std::move(a);
  EXPECT_EQ(a.id(), 0U);  // NOLINT(bugprone-use-after-move): what is tested
  EXPECT_EQ(a.size(), 0U);
  gpu::Buffer c("c", 32);
  c = std::move(b);
  EXPECT_EQ(b.id(), 0U);  // NOLINT(bugprone-use-after-move): what is tested
  EXPECT_EQ(c.size(), 16U);
}

TEST_F(ObjectsTest, IncompleteFramebufferIsAFailure) {
  const gpu::Texture a = gpu::Texture::make2d("a", {4, 4}, GL_RGBA8, gpu::Sampling::kNearestClamp);
  EXPECT_EQ(codeOf([&] { gpu::Framebuffer("wrong", {&a}, &a); }), Code::kInternal);
  glGetError();
}

// Broken by: leaving out the fence, on hardware.
TEST_F(ObjectsTest, ReadbackHoldsTheBytesAfterItsFence) {
  const std::vector<float> values = {1.0F, 2.0F, 3.0F, 4.0F};
  const gpu::Buffer source = test::bufferOf(values);
  gpu::Readback readback("r", 16);
  readback.copyFrom(source, 0, 0, 16);
  const gpu::Fence fence = gpu::Fence::insert();
  while (!fence.signalled()) {
  }
  EXPECT_EQ(std::memcmp(readback.bytes().data(), values.data(), 16), 0);
}

TEST_F(ObjectsTest, EmptyFenceIsSignalled) { EXPECT_TRUE(gpu::Fence().signalled()); }

}  // namespace
}  // namespace lpv
