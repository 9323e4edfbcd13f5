#include "reference/display.h"

#include <cmath>

namespace lpv::reference {

double curve(double x) {
  if (x <= 0.0) return 0.0;
  // Divided by x^2, so that the largest numbers stay numbers.
  const double value = (2.51 + 0.03 / x) / (2.43 + 0.59 / x + 0.14 / x / x);
  return value < 1.0 ? value : 1.0;
}

double encodeSrgb(double linear) {
  if (linear <= 0.0) return 0.0;
  if (linear >= 1.0) return 1.0;
  return linear <= 0.0031308 ? linear * 12.92 : (std::pow(linear, 5.0 / 12.0) * 211.0 - 11.0) / 200.0;
}

double decodeSrgb(double coded) {
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (encodeSrgb(middle) < coded ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

glm::u8vec3 displayOf(const glm::dvec3& radiance, double ev) {
  glm::u8vec3 out(0);
  for (int c = 0; c < 3; ++c) {
    out[c] = std::uint8_t(std::floor(255.0 * encodeSrgb(curve(std::pow(2.0, ev) * radiance[c])) + 0.5));
  }
  return out;
}

std::vector<glm::u8vec3> displayOf(const std::vector<glm::dvec3>& radiance, double ev) {
  std::vector<glm::u8vec3> out;
  out.reserve(radiance.size());
  for (const glm::dvec3& c : radiance) out.push_back(displayOf(c, ev));
  return out;
}

}  // namespace lpv::reference
