#pragma once
// How far apart two pictures or two fields are (MATHS.md 5, metrics).

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "reference/field.h"

namespace lpv::reference {

/// Difference of two pictures of one size, per channel values; a is the one under test, b the truth.
struct PictureDifference {
  double max = 0.0;          ///< largest |a - b|
  double mean = 0.0;         ///< mean |a - b|
  double nrmse = 0.0;        ///< sqrt(mean (a - b)^2) / mean b; infinite where b is all 0 and a is not
  double shareBeyond = 0.0;  ///< share of pixels with a channel further apart than the threshold
};

/// Compares pixels where `mask` is true (all when empty). NaN and infinity count as an infinite difference. Throws
/// std::invalid_argument for sizes that differ.
PictureDifference compare(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b, double threshold,
                          const std::vector<bool>& mask = {});
PictureDifference compare(const std::vector<glm::u8vec3>& a, const std::vector<glm::u8vec3>& b, double threshold,
                          const std::vector<bool>& mask = {});

/// "max 0.1, mean 0.01, ...": for messages of failing tests.
std::string describe(const PictureDifference& difference);

/// Writes a binary PPM: the picture under test, the truth, and |a - b| times `gain`, side by side. For tests that fail.
void writeDifference(const std::string& path, int width, int height, const std::vector<glm::u8vec3>& a,
                     const std::vector<glm::u8vec3>& b, double gain = 8.0);

/// ||a - b|| / ||b|| over all coefficients; 0 when both are 0.
double relativeL2(const Field& a, const Field& b);
/// The same after a has been scaled by the one factor that brings it closest to b.
double shapeL2(const Field& a, const Field& b);
/// Largest |a - b| of any coefficient.
double largestDifference(const Field& a, const Field& b);

}  // namespace lpv::reference
