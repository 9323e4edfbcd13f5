#include "wire/compression.h"

#include <zstd.h>

#include <memory>

namespace lpv::wire {
namespace {

constexpr int kLevel = 1;  // 3 takes half as long again and gains nothing on deltas

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
  out.resize(size);  // cannot fail: the bound holds
  return out;
}

Expected<std::string> decompress(std::string_view frame, std::size_t maxBytes) {
  const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (size == ZSTD_CONTENTSIZE_ERROR) return broken("is none");
  if (size == ZSTD_CONTENTSIZE_UNKNOWN) return broken("does not say how large its content is");
  if (size > maxBytes) {
    return broken("announces " + std::to_string(size) + " bytes, allowed are " + std::to_string(maxBytes));
  }
  thread_local const std::unique_ptr<ZSTD_DCtx, Free> context(ZSTD_createDCtx());
  std::string out(std::size_t(size), '\0');
  const std::size_t got = ZSTD_decompressDCtx(context.get(), out.data(), out.size(), frame.data(), frame.size());
  if (ZSTD_isError(got)) return broken(std::string("is damaged: ") + ZSTD_getErrorName(got));
  if (got != out.size()) return broken("holds another size than it announces");
  return out;
}

}  // namespace lpv::wire
