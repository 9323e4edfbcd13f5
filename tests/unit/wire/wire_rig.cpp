#include "unit/wire/wire_rig.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace lpv::wire {

Volume fieldOf(const std::vector<Glow>& glows, const glm::ivec3& dims) {
  Volume volume;
  volume.grid = Grid{{0.0, 0.0, 0.0}, 0.25, dims};
  std::vector<float>& out = volume.layers.emplace_back(VolumeLayer{"", {}}).coefficients;
  for (int i = 0; i < dims.x * dims.y * dims.z; ++i) {
    const glm::dvec3 centre = volume.grid.cellCentre({i % dims.x, i / dims.x % dims.y, i / (dims.x * dims.y)});
    sh::Coefficients sum[3] = {};
    for (const Glow& glow : glows) {
      const glm::dvec3 to = glow.place - centre;
      const double distance2 = glm::dot(to, to) + glow.area;
      const double cosine = std::abs(glm::dot(glow.normal, to)) / std::sqrt(distance2);
      const sh::Coefficients light = sh::basis(glm::normalize(to)) * (glow.area * (cosine + 0.01) / distance2);
      const double radiance[] = {glow.red, 1.0, glow.blue};
      for (int colour = 0; colour < 3; ++colour) sum[colour] += radiance[colour] * light;
    }
    for (const sh::Coefficients& c : sum) {
      for (int m = 0; m < 4; ++m) out.push_back(float(c[m]));
    }
  }
  return volume;
}

Volume randomVolume(const glm::ivec3& dims, std::size_t layers, float magnitude, std::uint32_t seed) {
  Volume volume;
  volume.grid = Grid{{-1.0, 0.5, 2.0}, 0.25, dims};
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> value(-magnitude, magnitude);
  for (std::size_t layer = 0; layer < layers; ++layer) {
    VolumeLayer& out = volume.layers.emplace_back(VolumeLayer{"group" + std::to_string(layer), {}});
    out.coefficients.resize(volume.grid.cells() * 12);
    for (float& c : out.coefficients) c = value(generator);
  }
  return volume;
}

double furthest(const Volume& truth, const Volume& held) {
  double worst = 0.0;
  for (std::size_t l = 0; l < truth.layers.size(); ++l) {
    const std::vector<float>& a = truth.layers[l].coefficients;
    const std::vector<float>& b = held.layers[l].coefficients;
    float largest = 0.0F;
    for (std::size_t i = 0; i < a.size(); i += 4) largest = std::max(largest, a[i]);
    for (std::size_t i = 0; i < a.size(); i += 4) {
      const double own = std::max(double(a[i]), kDarkest * double(largest));
      const glm::dvec3 band1(double(a[i + 1]) - b[i + 1], double(a[i + 2]) - b[i + 2], double(a[i + 3]) - b[i + 3]);
      worst = std::max({worst, std::abs(double(a[i]) - b[i]) / own, glm::length(band1) / std::sqrt(3.0) / own});
    }
  }
  return worst;
}

Expected<VolumeStatePtr> decode(const VolumeState& sent, const EncodedVolume& encoded, const VolumeStatePtr& base) {
  VolumeDecoder decoder(sent.shape, encoded.compression, base);
  for (auto part = encoded.parts.rbegin(); part != encoded.parts.rend(); ++part) {
    if (Status status = decoder.add(part->bricks, part->payload); !status.ok()) return status;
  }
  return decoder.finish(encoded.checksum);
}

Status Wire::send(const Volume& volume) {
  skip(volume);
  delta_ = held_ && held_->shape == published_->shape;
  const VolumeStatePtr base = delta_ ? held_ : nullptr;
  const EncodedVolume encoded = encodeVolume(*published_, base.get(), Compression::kZstd, kMaxPayloadBytes);
  bytes_ = 0;
  for (const Part& part : encoded.parts) bytes_ += part.payload.size();
  const Expected<VolumeStatePtr> state = decode(*published_, encoded, base);
  if (state) held_ = *state;
  return state.status();
}

void Wire::skip(const Volume& volume) { published_ = publish(volume, format_, class_, published_.get()); }

}  // namespace lpv::wire
