#include "encode/frame_codec.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

namespace lpv::encode {
namespace {

/// Encodes `pixels` in the format of `name`'s extension. Thread-safe: OpenImageIO keeps errors per writer.
Expected<std::string> write(const char* name, const OIIO::ImageSpec& spec, OIIO::TypeDesc type, const void* pixels) {
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput target(bytes);
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(name, &target);
  if (!out) return Status(Code::kInternal, std::string("no writer for ") + name + ": " + OIIO::geterror());
  if (!out->open(name, spec) || !out->write_image(type, pixels) || !out->close()) {
    return Status(Code::kInternal, std::string("encoding ") + name + " failed: " + out->geterror());
  }
  return std::string(bytes.begin(), bytes.end());
}

Status checkPixels(const glm::ivec2& size, std::size_t values) {
  if (size.x > 0 && size.y > 0 && values == std::size_t(size.x) * std::size_t(size.y) * 3) return {};
  return Status(Code::kInternal, "a frame of " + std::to_string(size.x) + " x " + std::to_string(size.y) +
                                     " pixels has " + std::to_string(values) + " values");
}

OIIO::ImageSpec spec(const glm::ivec2& size, OIIO::TypeDesc type) { return OIIO::ImageSpec(size.x, size.y, 3, type); }

}  // namespace

Expected<std::string> jpeg(const glm::ivec2& size, const std::vector<std::uint8_t>& rgb, int quality) {
  if (Status s = checkPixels(size, rgb.size()); !s.ok()) return s;
  OIIO::ImageSpec jpegSpec = spec(size, OIIO::TypeDesc::UINT8);
  jpegSpec.attribute("Compression", "jpeg:" + std::to_string(quality));
  return write("frame.jpg", jpegSpec, OIIO::TypeDesc::UINT8, rgb.data());
}

Expected<std::string> png(const glm::ivec2& size, const std::vector<std::uint8_t>& rgb) {
  if (Status s = checkPixels(size, rgb.size()); !s.ok()) return s;
  OIIO::ImageSpec pngSpec = spec(size, OIIO::TypeDesc::UINT8);
  pngSpec.attribute("png:compressionLevel", 1);
  pngSpec.attribute("oiio:ColorSpace", "sRGB");
  return write("frame.png", pngSpec, OIIO::TypeDesc::UINT8, rgb.data());
}

Expected<std::string> exr(const glm::ivec2& size, const std::vector<float>& rgb) {
  if (Status s = checkPixels(size, rgb.size()); !s.ok()) return s;
  OIIO::ImageSpec exrSpec = spec(size, OIIO::TypeDesc::FLOAT);
  exrSpec.attribute("compression", "zip");
  exrSpec.attribute("oiio:ColorSpace", "Linear");
  return write("frame.exr", exrSpec, OIIO::TypeDesc::FLOAT, rgb.data());
}

}  // namespace lpv::encode
