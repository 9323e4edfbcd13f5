#include "reference/mipmap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "reference/display.h"
#include "reference/texel.h"

namespace lpv::reference {
namespace {

std::size_t wrap(std::int64_t i, int size) { return std::size_t(((i % size) + size) % size); }

MipLevel emptyLevel(int width, int height) {
  return {width, height, std::vector<glm::dvec3>(std::size_t(width) * std::size_t(height), glm::dvec3(0.0))};
}

MipLevel decoded(const Texture& texture) {
  MipLevel level = emptyLevel(texture.width, texture.height);
  if (texture.format == TexelFormat::kRgb8Srgb) {
    std::array<double, 256> linear{};
    for (std::size_t code = 0; code < 256; ++code) linear[code] = decodeSrgb(double(code) / 255.0);
    for (std::size_t i = 0; i < level.texels.size(); ++i) {
      for (int c = 0; c < 3; ++c) level.texels[i][c] = linear[texture.texels.at(3 * i + std::size_t(c))];
    }
    return level;
  }
  for (std::size_t i = 0; i < level.texels.size(); ++i) {
    level.texels[i] = texel(texture, int(i) % texture.width, int(i) / texture.width);
  }
  return level;
}

/// Which texels of `size` the i-th of `half` covers, and what part of its length each of them makes up.
std::vector<std::pair<int, double>> footprint(int i, int size, int half) {
  const double length = double(size) / half;
  std::vector<std::pair<int, double>> out;
  for (int k = int(i * length); k < size && k < (i + 1) * length; ++k) {
    const double covered = std::min((i + 1) * length, k + 1.0) - std::max(i * length, double(k));
    if (covered > 0.0) out.emplace_back(k, covered / length);
  }
  return out;
}

MipLevel halved(const MipLevel& level) {
  MipLevel half = emptyLevel(std::max(1, level.width / 2), std::max(1, level.height / 2));
  for (int y = 0; y < half.height; ++y) {
    const auto rows = footprint(y, level.height, half.height);
    for (int x = 0; x < half.width; ++x) {
      glm::dvec3& sum = half.texels[std::size_t(y) * std::size_t(half.width) + std::size_t(x)];
      for (const auto& [column, share] : footprint(x, level.width, half.width)) {
        for (const auto& [row, part] : rows) sum += share * part * level.at(column, row);
      }
    }
  }
  return half;
}

}  // namespace

const glm::dvec3& MipLevel::at(std::int64_t x, std::int64_t y) const {
  return texels[wrap(y, height) * std::size_t(width) + wrap(x, width)];
}

MipChain mipChainOf(const Texture& texture) {
  MipChain chain;
  chain.levels.push_back(decoded(texture));
  while (chain.levels.back().width > 1 || chain.levels.back().height > 1) {
    chain.levels.push_back(halved(chain.levels.back()));
  }
  return chain;
}

glm::dvec3 bilinear(const MipLevel& level, const glm::dvec2& uv) {
  const double x = uv.x * level.width - 0.5;
  const double y = uv.y * level.height - 0.5;
  const auto left = std::int64_t(std::floor(x));
  const auto top = std::int64_t(std::floor(y));
  const double fx = x - double(left);
  const double fy = y - double(top);
  const glm::dvec3 upper = (1.0 - fx) * level.at(left, top) + fx * level.at(left + 1, top);
  const glm::dvec3 lower = (1.0 - fx) * level.at(left, top + 1) + fx * level.at(left + 1, top + 1);
  return (1.0 - fy) * upper + fy * lower;
}

glm::dvec3 trilinear(const MipChain& chain, const glm::dvec2& uv, double lambda) {
  const double clamped = std::clamp(lambda, 0.0, double(chain.levels.size() - 1));
  const auto finer = std::size_t(clamped);
  const std::size_t coarser = std::min(finer + 1, chain.levels.size() - 1);
  const double f = clamped - double(finer);
  return (1.0 - f) * bilinear(chain.levels[finer], uv) + f * bilinear(chain.levels[coarser], uv);
}

}  // namespace lpv::reference
