#pragma once
// What surfaces let through: (1 - alpha) x transmission of the light that meets them, straight on
// (proto/lpv/v1/scene.proto, Surface).

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "scene/scene.h"

namespace lpv {

/// Alpha over a texture: means over boxes of its texels, kMostAlphaBoxes across at most. The texture repeats.
struct AlphaMap {
  glm::ivec2 size{0};                ///< boxes across and down, >= 1
  std::vector<std::uint8_t> alphas;  ///< row by row, of 255

  /// 0..1, of the box that holds uv; (0, 0) is the corner of the first texel.
  double at(const glm::dvec2& uv) const;
};
using AlphaMapPtr = std::shared_ptr<const AlphaMap>;

inline constexpr int kMostAlphaBoxes = 256;

/// What a surface stops of light.
struct Coverage {
  double alpha = 1.0;            ///< 0..1; times what the map says
  AlphaMapPtr map;               ///< null: alpha is the same all over
  glm::dvec3 transmission{1.0};  ///< per colour, 0..1: what passes where alpha is 0

  bool operator==(const Coverage&) const = default;

  bool isOpaque() const;
  /// Light passes as if nothing were there.
  bool letsAllThrough() const;
  /// Per colour, of light that meets the surface at texture coordinates `uv`; not read without map.
  glm::dvec3 through(const glm::dvec2& uv) const;
};

/// A surface's. A map is made at the first call, some 10 ms for 4 million texels, and is the same object for the same
/// texture and threshold while somebody holds it. Thread-safe.
Coverage coverageOf(const Surface& surface);

/// False where the surface cannot change light on its way, as far as it goes without a look at texels.
bool canStop(const Surface& surface);

/// Alpha of a texel, 0..255, as the surface's mode takes it: 0..1.
double alphaOf(const Surface& surface, std::uint8_t texel);

/// Whether alpha varies over the surface: it has a texture with alpha that its mode reads, and texture coordinates.
bool alphaVaries(const Surface& surface);

/// From this alpha on cameras see a surface, below it they see through (BLEND).
inline constexpr double kSeenAlpha = 0.5;

}  // namespace lpv
