#include "wire/compression.h"

#include <zstd.h>

#include <memory>

namespace lpv::wire {
namespace {

constexpr int kLevel = 1;  // level 3 takes 1.5x as long and deltas become no smaller

struct Free {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

Status broken(const std::string& what) { return invalid("part.payload", "the zstd frame " + what); }

}  // namespace

std::string compress(std::string_view content) {
  thread_local const std::unique_ptr<ZSTD_CCtx, Free> context(ZSTD_createCCtx());
  std::string out(ZSTD_compressBound(content.size()), '\0');
  const std::size_t size =
      ZSTD_compressCCtx(context.get(), out.data(), out.size(), content.data(), content.size(), kLevel);
  out.resize(size);  // cannot fail: the buffer has ZSTD_compressBound bytes
  return out;
}

Expected<std::string> decompress(std::string_view frame, std::size_t maxBytes) {
  const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (size == ZSTD_CONTENTSIZE_ERROR) return broken("has no valid header");
  if (size == ZSTD_CONTENTSIZE_UNKNOWN) return broken("does not have its content's size in the header");
  if (size > maxBytes) {
    return broken("announces " + std::to_string(size) + " bytes; the limit is " + std::to_string(maxBytes));
  }
  thread_local const std::unique_ptr<ZSTD_DCtx, Free> context(ZSTD_createDCtx());
  std::string out(std::size_t(size), '\0');
  const std::size_t got = ZSTD_decompressDCtx(context.get(), out.data(), out.size(), frame.data(), frame.size());
  if (ZSTD_isError(got)) return broken(std::string("is damaged: ") + ZSTD_getErrorName(got));
  if (got != out.size()) return broken("decompresses to another size than its header says");
  return out;
}

}  // namespace lpv::wire
