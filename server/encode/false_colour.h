#pragma once
// Illuminance as colours, with a legend.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace lpv::encode {

/// Lumen per watt: of white light in the renderers that say so (Radiance's WHTEFFICACY).
inline constexpr double kLumensPerWatt = 179.0;
/// From the darkest colour to the brightest.
inline constexpr int kFalseColourDecades = 2;

/// Lux of linear irradiance, W/m^2 of red, green and blue (Rec. 709).
double luxOf(const glm::vec3& irradiance);

/// The brightest colour's lux: 1, 2 or 5 times a power of ten, the least that a hundredth of the pixels that receive
/// light at most exceeds. 1 where none does.
double brightestLux(const std::vector<float>& irradiance);

/// Colour of so many lux where the brightest stands for `top`: from violet through green to yellow, by the logarithm
/// over kFalseColourDecades; black at 0.
glm::u8vec3 falseColour(double lux, double top);

/// A picture of `irradiance` (3 floats per pixel) in these colours; where there is room, with a legend in its lower
/// left corner. 3 bytes per pixel.
std::vector<std::uint8_t> falseColours(const glm::ivec2& size, const std::vector<float>& irradiance);

}  // namespace lpv::encode
