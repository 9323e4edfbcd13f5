// Frames as files, read back by OpenImageIO, which did not write them.

#include "encode/frame_codec.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace lpv::encode {
namespace {

using ::testing::HasSubstr;

const glm::ivec2 kSize(83, 47);  // no multiple of a block or of a line of compression

/// Smooth, and different in every channel, row and column.
double shade(int x, int y, int channel) { return 0.5 + 0.45 * std::sin(0.11 * x * (channel + 1) + 0.07 * y); }

template <typename Value>
std::vector<Value> picture(double scale) {
  std::vector<Value> out;
  for (int y = 0; y < kSize.y; ++y)
    for (int x = 0; x < kSize.x; ++x)
      for (int channel = 0; channel < 3; ++channel) out.push_back(Value(scale * shade(x, y, channel)));
  return out;
}

struct Read {
  OIIO::ImageSpec spec;
  std::vector<float> values;  ///< RGB, rows from the top; integers as 0..1
};

Read read(const std::string& name, const std::string& file) {
  Read out;
  OIIO::Filesystem::IOMemReader source(file.data(), file.size());
  const auto in = OIIO::ImageInput::open(name, nullptr, &source);
  EXPECT_TRUE(in) << OIIO::geterror();
  if (!in) return out;
  out.spec = in->spec();
  out.values.resize(out.spec.image_pixels() * std::size_t(out.spec.nchannels));
  EXPECT_TRUE(in->read_image(0, 0, 0, -1, OIIO::TypeDesc::FLOAT, out.values.data())) << in->geterror();
  return out;
}

void expectShape(const Read& read, OIIO::TypeDesc type) {
  EXPECT_EQ(read.spec.width, kSize.x);
  EXPECT_EQ(read.spec.height, kSize.y);
  EXPECT_EQ(read.spec.nchannels, 3);
  EXPECT_EQ(read.spec.format, type);
}

// Broken by: rows from the bottom, channels in another order.
TEST(FrameCodec, PngKeepsEveryValueAndSaysThatItIsSrgb) {
  const auto rgb = picture<std::uint8_t>(255);
  const Expected<std::string> file = png(kSize, rgb);
  ASSERT_TRUE(file) << file.status().message();
  const Read back = read("frame.png", *file);
  expectShape(back, OIIO::TypeDesc::UINT8);
  EXPECT_EQ(back.spec.get_string_attribute("oiio:ColorSpace"), "sRGB");
  ASSERT_EQ(back.values.size(), rgb.size());
  for (std::size_t i = 0; i < rgb.size(); ++i) ASSERT_EQ(std::lround(255 * back.values[i]), rgb[i]) << i;
}

// Values beyond 1, tiny and negative ones are kept bit for bit. Broken by: half floats, or a stride of one row.
TEST(FrameCodec, ExrKeepsEveryFloat) {
  auto rgb = picture<float>(1);
  rgb[7] = 1e6F;
  rgb[8] = 1e-30F;
  rgb[9] = -3.25F;
  const Expected<std::string> file = exr(kSize, rgb);
  ASSERT_TRUE(file) << file.status().message();
  const Read back = read("frame.exr", *file);
  expectShape(back, OIIO::TypeDesc::FLOAT);
  EXPECT_EQ(back.spec.get_string_attribute("compression"), "zip");
  EXPECT_EQ(back.values, rgb);
}

double worst(const std::vector<float>& read, const std::vector<std::uint8_t>& rgb) {
  double out = 0;
  for (std::size_t i = 0; i < rgb.size() && i < read.size(); ++i)
    out = std::max(out, std::abs(255.0 * read[i] - rgb[i]));
  return out;
}

// Colours are kept at half the resolution (4:2:0), so that steep ones are off by more than quantisation.
TEST(FrameCodec, JpegIsCloserAndLargerWithQuality) {
  const auto rgb = picture<std::uint8_t>(255);
  const Expected<std::string> fine = jpeg(kSize, rgb, 95);
  const Expected<std::string> coarse = jpeg(kSize, rgb, 20);
  ASSERT_TRUE(fine && coarse);
  const Read back = read("frame.jpg", *fine);
  expectShape(back, OIIO::TypeDesc::UINT8);
  EXPECT_LT(worst(back.values, rgb), 40);
  EXPECT_LT(worst(back.values, rgb), worst(read("frame.jpg", *coarse).values, rgb));
  EXPECT_GT(fine->size(), coarse->size());
}

TEST(FrameCodec, TheSamePixelsGiveTheSameBytes) {
  const auto bytes = picture<std::uint8_t>(255);
  const auto floats = picture<float>(1);
  EXPECT_EQ(*png(kSize, bytes), *png(kSize, bytes));
  EXPECT_EQ(*jpeg(kSize, bytes, 80), *jpeg(kSize, bytes, 80));
  EXPECT_EQ(*exr(kSize, floats), *exr(kSize, floats));
}

TEST(FrameCodec, RefusesPixelsThatDoNotFillTheFrame) {
  EXPECT_THAT(png(kSize, {1, 2, 3}).status().message(), HasSubstr("83 x 47"));
  EXPECT_THAT(jpeg(kSize, {1, 2, 3}, 80).status().message(), HasSubstr("3 values"));
  EXPECT_THAT(exr({0, 1}, {}).status().message(), HasSubstr("0 x 1"));
}

}  // namespace
}  // namespace lpv::encode
