#include "scene/tonemap.h"

#include <algorithm>
#include <cmath>

namespace lpv {

double toneCurve(double x) {
  if (!(x > 0.0)) return 0.0;  // NaN too
  x = std::min(x, 1e6);        // far beyond white; larger numbers would divide infinity by infinity
  return std::clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}

double srgbFromLinear(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
}

double linearFromSrgb(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }

glm::u8vec3 displayFromRadiance(const glm::dvec3& radiance, double ev) {
  const double gain = std::exp2(ev);
  glm::u8vec3 out;
  for (int c = 0; c < 3; ++c) {
    out[c] = static_cast<std::uint8_t>(std::lround(255.0 * srgbFromLinear(toneCurve(radiance[c] * gain))));
  }
  return out;
}

}  // namespace lpv
