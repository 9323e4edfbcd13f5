#include "encode/frame_codec.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <png.h>
#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>

namespace lpv::encode {
namespace {

Status checkPixels(const glm::ivec2& size, std::size_t values) {
  if (size.x > 0 && size.y > 0 && values == std::size_t(size.x) * std::size_t(size.y) * 3) return {};
  return Status(Code::kInternal, "a frame of " + std::to_string(size.x) + " x " + std::to_string(size.y) +
                                     " pixels has " + std::to_string(values) + " values");
}

Status failed(const char* format, const char* why) {
  return Status(Code::kInternal, std::string("encoding ") + format + " failed: " + why);
}

/// Files are written to strings that had room for all pixels: memory that is not written to is none, and growing would
/// copy. What is left over is given back where it is most of it.
std::string fitted(std::string file) {
  if (file.size() < file.capacity() / 4) file.shrink_to_fit();
  return file;
}

/// What libpng writes into, and what it says when it fails.
struct PngWork {
  std::string file;
  std::array<char, 64> error{"no memory"};
};

[[noreturn]] void onPngError(png_structp coder, png_const_charp why) {
  std::snprintf(static_cast<PngWork*>(png_get_error_ptr(coder))->error.data(), sizeof(PngWork::error), "%s", why);
  png_longjmp(coder, 1);
}

void appendPng(png_structp coder, png_bytep bytes, std::size_t count) {
  try {
    static_cast<PngWork*>(png_get_io_ptr(coder))->file.append(reinterpret_cast<const char*>(bytes), count);
  } catch (const std::bad_alloc&) {
    png_error(coder, "no memory");
  }
}

/// False where libpng failed: it jumps here, so that nothing in this function may have a destructor.
bool writePng(png_structp coder, png_infop info, const glm::ivec2& size, const std::uint8_t* rgb) {
  if (setjmp(png_jmpbuf(coder)) != 0) return false;  // NOLINT(cert-err52-cpp): libpng's way of failing
  png_set_write_fn(coder, png_get_error_ptr(coder), appendPng, nullptr);
  png_set_compression_level(coder, 1);
  png_set_IHDR(coder, info, png_uint_32(size.x), png_uint_32(size.y), 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(coder, info, PNG_sRGB_INTENT_ABSOLUTE);
  png_write_info(coder, info);
  for (int y = 0; y < size.y; ++y) png_write_row(coder, rgb + 3 * std::size_t(y) * std::size_t(size.x));
  png_write_end(coder, info);
  return true;
}

/// What OpenEXR writes into.
class Memory : public Imf::OStream {
 public:
  explicit Memory(std::size_t most) : Imf::OStream("memory") { text_.reserve(most); }

  void write(const char* bytes, int count) override {
    const std::size_t end = at_ + std::size_t(count);
    if (end > text_.size()) text_.resize(end);
    std::copy_n(bytes, count, text_.begin() + std::ptrdiff_t(at_));
    at_ = end;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = std::size_t(at); }

  std::string take() { return fitted(std::move(text_)); }

 private:
  std::string text_;
  std::size_t at_ = 0;
};

Imf::Header exrHeader(const glm::ivec2& size) {
  Imf::Header header(size.x, size.y);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const char* channel : {"R", "G", "B"}) header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
  return header;
}

/// OpenEXR reads through char*, and changes nothing.
Imf::FrameBuffer exrPixels(const glm::ivec2& size, const std::vector<float>& rgb) {
  const std::size_t pixel = 3 * sizeof(float);
  const std::array<const char*, 3> channels{"R", "G", "B"};
  Imf::FrameBuffer out;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    char* const first = reinterpret_cast<char*>(const_cast<float*>(rgb.data() + i));
    out.insert(channels[i], Imf::Slice(Imf::FLOAT, first, pixel, pixel * std::size_t(size.x)));
  }
  return out;
}

}  // namespace

Expected<std::string> jpeg(const glm::ivec2& size, const std::vector<std::uint8_t>& rgb, int quality) {
  if (Status s = checkPixels(size, rgb.size()); !s.ok()) return s;
  const std::unique_ptr<void, decltype(&tjDestroy)> coder(tjInitCompress(), tjDestroy);
  if (!coder) return failed("JPEG", tjGetErrorStr2(nullptr));
  unsigned char* bytes = nullptr;
  unsigned long count = 0;
  const int status = tjCompress2(coder.get(), rgb.data(), size.x, 0, size.y, TJPF_RGB, &bytes, &count, TJSAMP_420,
                                 quality, TJFLAG_ACCURATEDCT);
  const std::unique_ptr<unsigned char, decltype(&tjFree)> owned(bytes, tjFree);
  if (status != 0) return failed("JPEG", tjGetErrorStr2(coder.get()));
  return std::string(bytes, bytes + count);
}

Expected<std::string> png(const glm::ivec2& size, const std::vector<std::uint8_t>& rgb) {
  if (Status s = checkPixels(size, rgb.size()); !s.ok()) return s;
  PngWork work;
  work.file.reserve(rgb.size());
  png_structp coder = png_create_write_struct(PNG_LIBPNG_VER_STRING, &work, onPngError, nullptr);
  png_infop info = coder == nullptr ? nullptr : png_create_info_struct(coder);
  const bool written = info != nullptr && writePng(coder, info, size, rgb.data());
  png_destroy_write_struct(&coder, &info);
  if (!written) return failed("PNG", work.error.data());
  return fitted(std::move(work.file));
}

Expected<std::string> exr(const glm::ivec2& size, const std::vector<float>& rgb) {
  if (Status s = checkPixels(size, rgb.size()); !s.ok()) return s;
  try {
    Memory memory(rgb.size() * sizeof(float));
    {
      Imf::OutputFile file(memory, exrHeader(size), 0);  // on this thread: those beside it have work of their own
      file.setFrameBuffer(exrPixels(size, rgb));
      file.writePixels(size.y);
    }
    return memory.take();
  } catch (const std::exception& error) {
    return failed("EXR", error.what());
  }
}

}  // namespace lpv::encode
