#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "lpv/resources/lights.h"

namespace lpv {

/// The field is kept per channel of colour, not per colour: lights of one chromaticity share a channel, whose colour is
/// applied at the end. Transport is linear, so this is exact, and one white light costs a third. A textured light has
/// every colour.
struct Palette {
  int channels = 1;  ///< 1..3; 3 is always red, green, blue
  std::array<glm::dvec3, 3> radiance{};  ///< rgb of each channel's unit, that of its radianceScale light
  std::vector<glm::dvec3> weights;  ///< per light: share of each channel's unit, 0..1
};
Palette choosePalette(const std::vector<EmittingLight>& lights);

}  // namespace lpv
