#include "bench/codec_error.h"

#include "scene/lookup.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lpv::bench {
namespace {

constexpr double kDarkest = 1e-5;  // of the largest fluence
const std::array<glm::dvec3, 6> kNormals{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

sh::Coefficients at(const VolumeLayer& layer, std::size_t i) {
  const float* c = layer.coefficients.data() + i;
  return {c[0], c[1], c[2], c[3]};
}

double largestFluence(const VolumeLayer& layer) {
  double largest = 0.0;
  for (std::size_t i = 0; i < layer.coefficients.size(); i += 4) largest = std::max(largest, sh::fluence(at(layer, i)));
  return largest;
}

/// Sums over the normals, and the largest difference.
struct Difference {
  double squared = 0.0;
  double light = 0.0;
  double largest = 0.0;
};

Difference difference(const sh::Coefficients& truth, const sh::Coefficients& held) {
  Difference out;
  for (const glm::dvec3& n : kNormals) {
    const double e = irradianceCap(truth, n);
    const double off = std::abs(irradianceCap(held, n) - e);
    out.squared += off * off;
    out.light += e * e;
    out.largest = std::max(out.largest, off);
  }
  return out;
}

}  // namespace

AddedError addedError(const Volume& truth, const Volume& held) {
  AddedError out;
  double squared = 0.0;
  double light = 0.0;
  for (std::size_t l = 0; l < truth.layers.size(); ++l) {
    const double dark = kDarkest * largestFluence(truth.layers[l]);
    for (std::size_t i = 0; i < truth.layers[l].coefficients.size(); i += 4) {
      const sh::Coefficients a = at(truth.layers[l], i);
      const sh::Coefficients b = at(held.layers[l], i);
      const Difference d = difference(a, b);
      squared += d.squared;
      light += d.light;
      const double fluence = sh::fluence(a);
      if (fluence <= dark) continue;
      out.cell = std::max(out.cell, d.largest / fluence);
      out.fluence = std::max(out.fluence, std::abs(sh::fluence(b) - fluence) / fluence);
    }
  }
  out.irradiance = light > 0.0 ? std::sqrt(squared / light) : 0.0;
  return out;
}

}  // namespace lpv::bench
