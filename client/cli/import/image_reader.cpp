// The module lpv_images: wraps OpenImageIO and its 300 libraries, which are loaded when the first image is read.

#include "import/image_reader.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include "scene/tonemap.h"
#include "wire/half.h"

namespace lpv::cli {
namespace {

constexpr int kMaxEdge = 16384;

Status unreadable(const std::string& name, const std::string& why) {
  return invalid("texture", name + ": " + (why.empty() ? "the image cannot be read" : why));
}

/// R, G, B of a texel with `channels` channels; a grey value is repeated.
template <typename T>
void rgbOf(const T* texel, int channels, T* rgb) {
  for (int c = 0; c < 3; ++c) rgb[c] = texel[channels >= 3 ? c : 0];
}

template <typename T>
Expected<std::vector<T>> readPixels(OIIO::ImageInput& input, OIIO::TypeDesc type, const std::string& name) {
  const OIIO::ImageSpec& spec = input.spec();
  const std::size_t texels = std::size_t(spec.width) * std::size_t(spec.height);
  std::vector<T> pixels(texels * std::size_t(spec.nchannels));
  if (!input.read_image(0, 0, 0, spec.nchannels, type, pixels.data())) return unreadable(name, input.geterror());
  std::vector<T> rgb(texels * 3);
  for (std::size_t i = 0; i < texels; ++i) rgbOf(&pixels[i * std::size_t(spec.nchannels)], spec.nchannels, &rgb[i * 3]);
  return rgb;
}

template <typename T>
std::vector<std::uint8_t> bytesOf(const std::vector<T>& values) {
  std::vector<std::uint8_t> bytes(values.size() * sizeof(T));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// Linear texels: halves if their range suffices, else floats.
void setLinear(Texture& texture, std::vector<float> rgb) {
  float largest = 0.0F;
  for (float& value : rgb) {
    if (!(value > 0.0F) || !std::isfinite(value)) value = 0.0F;
    largest = std::max(largest, value);
  }
  if (largest > wire::kMaxHalf) {
    texture.format = TexelFormat::kRgb32F;
    texture.texels = bytesOf(rgb);
    return;
  }
  std::vector<std::uint16_t> halves(rgb.size());
  wire::halvesFromFloats(rgb.data(), rgb.size(), 1.0F, halves.data());
  texture.format = TexelFormat::kRgb16F;
  texture.texels = bytesOf(halves);
}

/// R, G, B and alpha of an image that has alpha, in 8 bits; empty where all is opaque.
Expected<std::vector<std::uint8_t>> readWithAlpha(OIIO::ImageInput& input, const std::string& name) {
  const OIIO::ImageSpec& spec = input.spec();
  const auto channels = std::size_t(spec.nchannels), texels = std::size_t(spec.width) * std::size_t(spec.height);
  std::vector<std::uint8_t> pixels(texels * channels);
  if (!input.read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, pixels.data()))
    return unreadable(name, input.geterror());
  std::vector<std::uint8_t> out(texels * 4);
  bool opaque = true;
  for (std::size_t i = 0; i < texels; ++i) {
    rgbOf(&pixels[i * channels], spec.nchannels, &out[i * 4]);
    out[i * 4 + 3] = pixels[i * channels + std::size_t(spec.alpha_channel)];
    opaque = opaque && out[i * 4 + 3] == 255;
  }
  if (opaque) out.clear();
  return out;
}

Expected<Texture> readTexture(OIIO::ImageInput& input, const std::string& name, ImageUse use) {
  const OIIO::ImageSpec& spec = input.spec();
  if (spec.width < 1 || spec.height < 1 || spec.width > kMaxEdge || spec.height > kMaxEdge || spec.nchannels < 1) {
    return unreadable(name, "the image has " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                                " texels; allowed are 1..16384 along each side");
  }
  Texture texture;
  texture.width = spec.width;
  texture.height = spec.height;
  const bool hasAlpha = spec.alpha_channel >= 0 && spec.alpha_channel < spec.nchannels;
  if (use == ImageUse::kColourWithAlpha && hasAlpha && !spec.format.is_floating_point()) {
    auto rgba = readWithAlpha(input, name);
    if (!rgba) return rgba.status();
    if (!rgba->empty()) {
      texture.format = TexelFormat::kRgba8Srgb;
      texture.texels = std::move(*rgba);
      return texture;
    }
  }
  if (spec.format == OIIO::TypeDesc::UINT8) {
    auto rgb = readPixels<std::uint8_t>(input, OIIO::TypeDesc::UINT8, name);
    if (!rgb) return rgb.status();
    texture.texels = std::move(*rgb);
    if (use == ImageUse::kNumbers) texture.format = TexelFormat::kRgb8;
    return texture;
  }
  auto rgb = readPixels<float>(input, OIIO::TypeDesc::FLOAT, name);
  if (!rgb) return rgb.status();
  if (!spec.format.is_floating_point() && use != ImageUse::kNumbers) {
    for (float& value : *rgb) value = float(linearFromSrgb(value));
  }
  setLinear(texture, std::move(*rgb));
  return texture;
}

Expected<Texture> open(const std::string& name, OIIO::Filesystem::IOProxy* memory, ImageUse use) {
  OIIO::ImageSpec config;
  config["oiio:UnassociatedAlpha"] = 1;
  if (memory != nullptr) config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &memory);
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(name, &config, memory);
  if (!input) return unreadable(name, OIIO::geterror());
  Expected<Texture> texture = readTexture(*input, name, use);
  OIIO::geterror();  // an error left pending would be printed at exit
  return texture;
}

}  // namespace

}  // namespace lpv::cli

extern "C" lpv::cli::ReadImage lpvReadImage;
void lpvReadImage(const std::string& name, const std::string* bytes, lpv::cli::ImageUse use,
                  lpv::Expected<lpv::Texture>& out) {
  if (bytes == nullptr) {
    out = lpv::cli::open(name, nullptr, use);
    return;
  }
  OIIO::Filesystem::IOMemReader memory(bytes->data(), bytes->size());
  out = lpv::cli::open(name, &memory, use);
}
