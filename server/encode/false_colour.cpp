#include "encode/false_colour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

namespace lpv::encode {

namespace {

/// Viridis (van der Walt and Smith 2015) at every fifth of its length, sRGB: even steps of lightness, also for those
/// who see red and green alike.
constexpr std::array<glm::u8vec3, 6> kColours = {
    {{68, 1, 84}, {65, 68, 135}, {42, 120, 142}, {34, 168, 132}, {122, 209, 81}, {253, 231, 37}}};

constexpr glm::ivec2 kGlyph(5, 7);  ///< pixels
constexpr int kAdvance = 6;
constexpr std::string_view kGlyphs = "0123456789.lx ";
/// Rows from the top, bit 4 the leftmost pixel; in the order of kGlyphs.
constexpr std::array<std::array<std::uint8_t, 7>, 14> kRows = {{{14, 17, 19, 21, 25, 17, 14},
                                                                {4, 12, 4, 4, 4, 4, 14},
                                                                {14, 17, 1, 2, 4, 8, 31},
                                                                {31, 2, 4, 2, 1, 17, 14},
                                                                {2, 6, 10, 18, 31, 2, 2},
                                                                {31, 16, 30, 1, 1, 17, 14},
                                                                {6, 8, 16, 30, 17, 17, 14},
                                                                {31, 1, 2, 4, 8, 8, 8},
                                                                {14, 17, 17, 14, 17, 17, 14},
                                                                {14, 17, 17, 15, 1, 2, 12},
                                                                {0, 0, 0, 0, 0, 12, 12},
                                                                {12, 4, 4, 4, 4, 4, 14},
                                                                {0, 0, 17, 10, 4, 10, 17},
                                                                {0, 0, 0, 0, 0, 0, 0}}};

struct Canvas {
  glm::ivec2 size;
  std::vector<std::uint8_t>& rgb;

  void fill(const glm::ivec2& from, const glm::ivec2& extent, const glm::u8vec3& colour) const {
    for (int y = std::max(from.y, 0); y < std::min(from.y + extent.y, size.y); ++y) {
      for (int x = std::max(from.x, 0); x < std::min(from.x + extent.x, size.x); ++x) {
        for (int c = 0; c < 3; ++c)
          rgb[3 * (std::size_t(y) * std::size_t(size.x) + std::size_t(x)) + std::size_t(c)] = colour[c];
      }
    }
  }

  void write(const glm::ivec2& from, const std::string& text, int scale) const {
    for (std::size_t i = 0; i < text.size(); ++i) {
      const auto& rows = kRows[std::min(kGlyphs.find(text[i]), kGlyphs.size() - 1)];
      for (int y = 0; y < kGlyph.y; ++y) {
        for (int x = 0; x < kGlyph.x; ++x) {
          if ((rows[std::size_t(y)] >> (kGlyph.x - 1 - x) & 1) == 0) continue;
          fill(from + scale * glm::ivec2(int(i) * kAdvance + x, y), glm::ivec2(scale), glm::u8vec3(255));
        }
      }
    }
  }
};

/// "5000", "0.05": lux of the scale, which have one digit.
std::string numberOf(double lux) {
  if (lux >= 1.0) return std::to_string(std::llround(lux));
  std::string out = "0.";
  for (; lux < 0.0999 && out.size() < 12; lux *= 10.0) out += '0';
  return out + std::to_string(std::llround(10.0 * lux));
}

/// A bar of the colours over its decades' lux.
void drawLegend(const Canvas& canvas, double top) {
  const int scale = canvas.size.x >= 1280 ? 2 : 1, width = 240 * scale, margin = 8 * scale;
  const glm::ivec2 bar(width - 60 * scale, 8 * scale);
  const glm::ivec2 box(width, 3 * margin + bar.y / 2 + kGlyph.y * scale);
  if (canvas.size.x < box.x + 2 * margin || canvas.size.y < 4 * box.y) return;
  const glm::ivec2 corner(margin, canvas.size.y - margin - box.y), at = corner + margin;
  canvas.fill(corner, box, glm::u8vec3(24));
  for (int x = 0; x < bar.x; ++x) {
    const double decades = kFalseColourDecades * (1.0 - double(x) / (bar.x - 1));
    canvas.fill(at + glm::ivec2(x, 0), {1, bar.y}, falseColour(top * std::pow(10.0, -decades), top));
  }
  for (int i = 0; i <= kFalseColourDecades; ++i) {
    const std::string text =
        numberOf(top * std::pow(10.0, i - kFalseColourDecades)) + (i == kFalseColourDecades ? " lx" : "");
    canvas.write(at + glm::ivec2(bar.x * i / kFalseColourDecades - (i == 0 ? 0 : kAdvance * scale), bar.y + 4 * scale),
                 text, scale);
  }
}

glm::vec3 pixelOf(const std::vector<float>& rgb, std::size_t i) { return {rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]}; }

}  // namespace

double luxOf(const glm::vec3& irradiance) {
  return kLumensPerWatt *
         (0.2126 * double(irradiance.x) + 0.7152 * double(irradiance.y) + 0.0722 * double(irradiance.z));
}

double brightestLux(const std::vector<float>& irradiance) {
  std::vector<double> lit;
  for (std::size_t i = 0; i < irradiance.size() / 3; ++i) {
    if (const double lux = luxOf(pixelOf(irradiance, i)); lux > 0.0 && std::isfinite(lux)) lit.push_back(lux);
  }
  if (lit.empty()) return 1.0;
  const auto nearlyAll = lit.begin() + std::ptrdiff_t((lit.size() - 1) * 99 / 100);
  std::nth_element(lit.begin(), nearlyAll, lit.end());
  const double power = std::pow(10.0, std::floor(std::log10(*nearlyAll)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (*nearlyAll <= step * power) return step * power;
  }
  return 10.0 * power;
}

glm::u8vec3 falseColour(double lux, double top) {
  if (!(lux > 0.0)) return glm::u8vec3(0);
  const double share = 1.0 + std::log10(lux / top) / kFalseColourDecades;
  const double at = std::clamp(share, 0.0, 1.0) * double(kColours.size() - 1);
  const std::size_t below = std::min(std::size_t(at), kColours.size() - 2);
  return glm::u8vec3(
      glm::round(glm::mix(glm::dvec3(kColours[below]), glm::dvec3(kColours[below + 1]), at - double(below))));
}

std::vector<std::uint8_t> falseColours(const glm::ivec2& size, const std::vector<float>& irradiance) {
  const double top = brightestLux(irradiance);
  std::vector<std::uint8_t> out;
  out.reserve(irradiance.size());
  for (std::size_t i = 0; i < irradiance.size() / 3; ++i) {
    const glm::u8vec3 colour = falseColour(luxOf(pixelOf(irradiance, i)), top);
    out.insert(out.end(), {colour.x, colour.y, colour.z});
  }
  drawLegend({size, out}, top);
  return out;
}

}  // namespace lpv::encode
