#include "lpv/light_texture.h"

#include <algorithm>
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

/// 2 x 2 means; an odd last row or column counts twice.
Picture halved(const Picture& from) {
  Picture out;
  out.size = glm::max((from.size + 1) / 2, glm::ivec2(1));
  out.texels.reserve(std::size_t(out.size.x) * std::size_t(out.size.y));
  for (int y = 0; y < out.size.y; ++y) {
    for (int x = 0; x < out.size.x; ++x) {
      const glm::ivec2 a(2 * x, 2 * y), b = glm::min(a + 1, from.size - 1);
      out.texels.push_back(0.25F * (from.at(a.x, a.y) + from.at(b.x, a.y) + from.at(a.x, b.y) + from.at(b.x, b.y)));
    }
  }
  return out;
}

/// One row's integrals from texel centre 0 to every other one and, last, all the way round.
void appendIntegrals(const Picture& picture, int row, std::vector<double>& out) {
  glm::dvec3 sum(0.0);
  for (int x = 0; x <= picture.size.x; ++x) {
    out.insert(out.end(), {sum.r, sum.g, sum.b});
    const int here = x % picture.size.x, next = (x + 1) % picture.size.x;
    sum += 0.5 * (glm::dvec3(picture.at(here, row)) + glm::dvec3(picture.at(next, row)));
  }
}

int rowsAtOnce(const Picture& picture) {
  return int(std::max<std::size_t>(1, kPieceTexels / std::size_t(picture.size.x)));
}

Pieces uploadTexels(const Picture& picture, GpuLightTexture& out) {
  const int step = rowsAtOnce(picture);
  for (int row = 0; row < picture.size.y; row += step) {
    const int rows = std::min(step, picture.size.y - row);
    out.radiance.uploadRows(row, rows, GL_RGB, GL_FLOAT, &picture.at(0, row));
    co_yield piece(Stage::kUpload, rows);
  }
  out.radiance.generateMipmaps();
  co_yield piece(Stage::kUpload);
}

Pieces uploadIntegrals(const Picture& picture, GpuLightTexture& out) {
  const std::size_t rowBytes = (std::size_t(picture.size.x) + 1) * 3 * sizeof(double);
  out.rowIntegrals = gpu::Buffer("row integrals", rowBytes * std::size_t(picture.size.y), gpu::BufferUse::kDynamic);
  const int step = rowsAtOnce(picture);
  std::vector<double> integrals;
  for (int row = 0; row < picture.size.y; row += step) {
    integrals.clear();
    for (int y = row; y < std::min(row + step, picture.size.y); ++y) appendIntegrals(picture, y, integrals);
    out.rowIntegrals.update(rowBytes * std::size_t(row), gpu::bytesOf(std::span<const double>(integrals)));
    co_yield piece(Stage::kUpload, step);
  }
}

}  // namespace

Pieces uploadLightTexture(const TexturePtr& texture, GpuLightTexture& out) {
  Picture picture;
  picture.size = {texture->width, texture->height};
  picture.texels.reserve(std::size_t(texture->width) * std::size_t(texture->height));
  for (int row = 0; row < texture->height; ++row) {
    appendLinearRow(*texture, row, picture.texels);
    if (std::size_t(row % 512) == 511) co_yield piece(Stage::kUpload);
  }
  while (picture.texels.size() > kMostTexels) picture = halved(picture);
  out.source = texture;
  out.size = picture.size;
  out.levels = gpu::mipLevels(picture.size);
  out.radiance =
      gpu::Texture::make2d("light texture", picture.size, GL_RGBA32F, gpu::Sampling::kMipmapRepeat, out.levels);
  float brightest = 0.0F;
  for (const glm::vec3& c : picture.texels) {
    brightest = std::max({brightest, c.r, c.g, c.b});
    out.mean += glm::dvec3(c);
  }
  out.mean /= double(picture.texels.size());
  out.brightest = brightest > 0.0F ? double(brightest) : 1.0;
  co_await uploadTexels(picture, out);
  co_await uploadIntegrals(picture, out);
}

}  // namespace lpv
