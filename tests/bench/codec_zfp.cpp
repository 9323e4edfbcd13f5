#include "bench/codec_zfp.h"

#include <zfp.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <vector>

namespace lpv::bench {

namespace {

constexpr std::size_t kFields = 12;  // three colours, four coefficients

double cpuMs() { return 1e3 * double(std::clock()) / CLOCKS_PER_SEC; }

/// One field, there and back, in place.
void pack(std::vector<float>& field, const glm::ivec3& dims, double tolerance, ZfpVolume* out) {
  const std::unique_ptr<zfp_field, decltype(&zfp_field_free)> shape(
      zfp_field_3d(field.data(), zfp_type_float, std::size_t(dims.x), std::size_t(dims.y), std::size_t(dims.z)),
      zfp_field_free);
  const std::unique_ptr<zfp_stream, decltype(&zfp_stream_close)> zfp(zfp_stream_open(nullptr), zfp_stream_close);
  zfp_stream_set_accuracy(zfp.get(), tolerance);
  std::vector<std::byte> packed(zfp_stream_maximum_size(zfp.get(), shape.get()));
  const std::unique_ptr<bitstream, decltype(&stream_close)> bits(stream_open(packed.data(), packed.size()),
                                                                 stream_close);
  zfp_stream_set_bit_stream(zfp.get(), bits.get());
  zfp_stream_rewind(zfp.get());
  const double begun = cpuMs();
  const std::size_t bytes = zfp_compress(zfp.get(), shape.get());
  const double packedAt = cpuMs();
  zfp_stream_rewind(zfp.get());
  if (bytes == 0 || zfp_decompress(zfp.get(), shape.get()) == 0) std::abort();
  out->bytes += bytes;
  out->encodeMs += packedAt - begun;
  out->decodeMs += cpuMs() - packedAt;
}

}  // namespace

ZfpVolume throughZfp(const Volume& volume, double tolerance) {
  ZfpVolume out;
  out.decoded = volume;
  for (VolumeLayer& layer : out.decoded.layers) {
    float largest = 0.0F;
    for (std::size_t i = 0; i < layer.coefficients.size(); i += 4)
      largest = std::max(largest, std::abs(layer.coefficients[i]));
    std::vector<float> field(layer.coefficients.size() / kFields);
    for (std::size_t f = 0; f < kFields; ++f) {
      for (std::size_t cell = 0; cell < field.size(); ++cell) field[cell] = layer.coefficients[cell * kFields + f];
      pack(field, volume.grid.dims, tolerance * largest, &out);
      for (std::size_t cell = 0; cell < field.size(); ++cell) layer.coefficients[cell * kFields + f] = field[cell];
    }
  }
  return out;
}

}  // namespace lpv::bench
