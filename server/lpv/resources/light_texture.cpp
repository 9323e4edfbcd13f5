#include "lpv/resources/light_texture.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "gpu/gl.h"

namespace lpv {

namespace {

constexpr std::size_t kMostTexels = std::size_t(1) << 22;
constexpr std::size_t kPieceTexels = std::size_t(1) << 17;

struct Picture {
  glm::ivec2 size{0};
  std::vector<glm::vec3> texels;  ///< linear, row by row

  const glm::vec3& at(int x, int y) const { return texels[std::size_t(y) * std::size_t(size.x) + std::size_t(x)]; }
};

/// What a texel of the next mip level covers along one axis: three texels from 2 i on, the last one only of an odd
/// size.
struct Footprint {
  int first = 0;
  std::array<float, 3> weights{};
};

Footprint footprintOf(int i, int size) {
  if (size == 1) return {0, {1.0F, 0.0F, 0.0F}};
  if (size % 2 == 0) return {2 * i, {0.5F, 0.5F, 0.0F}};
  const double half = size / 2, whole = 2.0 + 1.0 / half;
  return {2 * i, {float((1.0 - i / half) / whole), float(1.0 / whole), float((i + 1.0) / half / whole)}};
}

glm::vec3 covered(const Picture& from, const Footprint& x, const Footprint& y) {
  glm::vec3 sum(0.0F);
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const float weight = x.weights[std::size_t(i)] * y.weights[std::size_t(j)];
      if (weight > 0.0F) sum += weight * from.at(x.first + i, y.first + j);
    }
  }
  return sum;
}

/// The next mip level: sizes halved and rounded down, every texel the mean of what it covers. Not the driver's chain:
/// for odd sizes each driver has its own.
Picture halved(const Picture& from) {
  Picture out;
  out.size = glm::max(from.size / 2, glm::ivec2(1));
  out.texels.reserve(std::size_t(out.size.x) * std::size_t(out.size.y));
  for (int y = 0; y < out.size.y; ++y) {
    for (int x = 0; x < out.size.x; ++x)
      out.texels.push_back(covered(from, footprintOf(x, from.size.x), footprintOf(y, from.size.y)));
  }
  return out;
}

/// Some rows' integrals.
struct Integrals {
  std::vector<double> colours, moments;
};

/// One row's integrals from texel centre 0 to every other one and, last, all the way round.
void appendIntegrals(const Picture& picture, int row, Integrals& out) {
  glm::dvec3 sum(0.0);
  glm::dvec2 moments(0.0);
  for (int x = 0; x <= picture.size.x; ++x) {
    out.colours.insert(out.colours.end(), {sum.r, sum.g, sum.b});
    out.moments.insert(out.moments.end(), {moments.x, moments.y});
    const glm::dvec3 here(picture.at(x % picture.size.x, row)), next(picture.at((x + 1) % picture.size.x, row));
    sum += 0.5 * (here + next);
    // Brightness rises evenly from l to r: its integrals times 1, f and f^2, f the distance from x.
    const double l = here.r + here.g + here.b, r = next.r + next.g + next.b;
    const double even = (l + r) / 2.0, first = (l + 2.0 * r) / 6.0, second = (l + 3.0 * r) / 12.0;
    moments += glm::dvec2(x * even + first, x * (x * even + 2.0 * first) + second);
  }
}

int rowsAtOnce(const Picture& picture) {
  return int(std::max<std::size_t>(1, kPieceTexels / std::size_t(picture.size.x)));
}

GpuTask uploadTexels(const Picture& picture, int level, const gpu::Texture& texture) {
  const int step = rowsAtOnce(picture);
  for (int row = 0; row < picture.size.y; row += step) {
    const int rows = std::min(step, picture.size.y - row);
    texture.uploadRows(row, rows, GL_RGB, GL_FLOAT, &picture.at(0, row), level);
    co_yield submitted(Stage::kUpload, double(rows) * picture.size.x * double(sizeof(glm::vec3)));
  }
}

GpuTask uploadLevels(Picture picture, const GpuLightTexture& out) {
  for (int level = 0; level < out.levels; ++level) {
    co_await uploadTexels(picture, level, out.radiance);
    picture = halved(picture);
    co_yield submitted(Stage::kUpload, 0.0);
  }
}

GpuTask uploadIntegrals(const Picture& picture, GpuLightTexture& out) {
  const std::size_t rowDoubles = std::size_t(picture.size.x) + 1, rows = std::size_t(picture.size.y);
  const std::size_t rowBytes = rowDoubles * 3 * sizeof(double), rowMomentBytes = rowDoubles * 2 * sizeof(double);
  out.rowIntegrals = gpu::Buffer("row integrals", rowBytes * rows, gpu::BufferUse::kDynamic, gpu::Undefined{});
  out.rowMoments = gpu::Buffer("row moments", rowMomentBytes * rows, gpu::BufferUse::kDynamic, gpu::Undefined{});
  const int step = rowsAtOnce(picture);
  Integrals integrals;
  for (int row = 0; row < picture.size.y; row += step) {
    integrals.colours.clear();
    integrals.moments.clear();
    for (int y = row; y < std::min(row + step, picture.size.y); ++y) appendIntegrals(picture, y, integrals);
    out.rowIntegrals.update(rowBytes * std::size_t(row), gpu::bytesOf(std::span<const double>(integrals.colours)));
    out.rowMoments.update(rowMomentBytes * std::size_t(row), gpu::bytesOf(std::span<const double>(integrals.moments)));
    co_yield submitted(Stage::kUpload, double(rowBytes + rowMomentBytes) * step);
  }
}

}  // namespace

GpuTask uploadLightTexture(const TexturePtr& texture, GpuLightTexture& out) {
  Picture picture;
  picture.size = {texture->width, texture->height};
  picture.texels.reserve(std::size_t(texture->width) * std::size_t(texture->height));
  for (int row = 0; row < texture->height; ++row) {
    appendLinearRow(*texture, row, picture.texels);
    if (std::size_t(row % 512) == 511) co_yield submitted(Stage::kUpload, 0.0);
  }
  while (picture.texels.size() > kMostTexels) picture = halved(picture);
  out.source = texture;
  out.size = picture.size;
  out.levels = gpu::mipLevels(picture.size);
  out.radiance =
      gpu::Texture::make2d("light texture", picture.size, GL_RGBA32F, gpu::Sampling::kMipmapRepeat, out.levels);
  float radianceScale = 0.0F;
  for (const glm::vec3& c : picture.texels) {
    radianceScale = std::max({radianceScale, c.r, c.g, c.b});
    out.mean += glm::dvec3(c);
  }
  out.mean /= double(picture.texels.size());
  out.radianceScale = radianceScale > 0.0F ? double(radianceScale) : 1.0;
  co_await uploadIntegrals(picture, out);
  co_await uploadLevels(std::move(picture), out);
}

}  // namespace lpv
