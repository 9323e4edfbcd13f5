#include "reference/compare.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace lpv::reference {
namespace {

template <typename Pixel>
PictureDifference comparePixels(const std::vector<Pixel>& a, const std::vector<Pixel>& b, double threshold,
                                const std::vector<bool>& mask) {
  if (a.size() != b.size() || (!mask.empty() && mask.size() != a.size())) {
    throw std::invalid_argument("compare: " + std::to_string(a.size()) + " against " + std::to_string(b.size()) +
                                " pixels, mask of " + std::to_string(mask.size()));
  }
  PictureDifference out;
  double sum = 0.0;
  double squares = 0.0;
  std::size_t pixels = 0;
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!mask.empty() && !mask[i]) continue;
    double worst = 0.0;
    for (int c = 0; c < 3; ++c) {
      double d = std::abs(double(a[i][c]) - double(b[i][c]));
      if (!std::isfinite(d)) d = std::numeric_limits<double>::infinity();
      worst = std::max(worst, d);
      out.mean += d;
      squares += d * d;
      sum += double(b[i][c]);
    }
    out.max = std::max(out.max, worst);
    if (worst > threshold) ++beyond;
    ++pixels;
  }
  if (pixels == 0) return out;
  const double channels = 3.0 * double(pixels);
  out.mean /= channels;
  out.nrmse = squares == 0.0 ? 0.0 : std::sqrt(squares / channels) / (sum / channels);
  out.shareBeyond = double(beyond) / double(pixels);
  return out;
}

void writeRow(std::ofstream& file, const glm::u8vec3* row, int width) {
  file.write(reinterpret_cast<const char*>(row), std::streamsize(width) * 3);
}

/// Sums of products over all coefficients of two fields of one size.
double product(const Field& a, const Field& b) {
  if (a.dims != b.dims) throw std::invalid_argument("fields of different dims");
  double sum = 0.0;
  for (std::size_t i = 0; i < a.cells.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) sum += glm::dot(a.cells[i][c], b.cells[i][c]);
  }
  return sum;
}

Field difference(const Field& a, const Field& b, double scaleOfA) {
  if (a.dims != b.dims) throw std::invalid_argument("fields of different dims");
  Field out(a.dims);
  for (std::size_t i = 0; i < a.cells.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) out.cells[i][c] = scaleOfA * a.cells[i][c] - b.cells[i][c];
  }
  return out;
}

double relativeNorm(const Field& d, const Field& truth) {
  const double norm = std::sqrt(product(d, d));
  return norm == 0.0 ? 0.0 : norm / std::sqrt(product(truth, truth));
}

}  // namespace

PictureDifference compare(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b, double threshold,
                          const std::vector<bool>& mask) {
  return comparePixels(a, b, threshold, mask);
}

PictureDifference compare(const std::vector<glm::u8vec3>& a, const std::vector<glm::u8vec3>& b, double threshold,
                          const std::vector<bool>& mask) {
  return comparePixels(a, b, threshold, mask);
}

std::string describe(const PictureDifference& d) {
  std::ostringstream out;
  out << "max " << d.max << ", mean " << d.mean << ", NRMSE " << d.nrmse << ", share beyond the threshold "
      << d.shareBeyond;
  return out.str();
}

void writeDifference(const std::string& path, int width, int height, const std::vector<glm::u8vec3>& a,
                     const std::vector<glm::u8vec3>& b, double gain) {
  std::vector<glm::u8vec3> apart(a.size());
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
    const glm::dvec3 d = glm::abs(glm::dvec3(a[i]) - glm::dvec3(b[i])) * gain;
    apart[i] = glm::u8vec3(glm::min(d, glm::dvec3(255.0)));
  }
  std::ofstream file(path, std::ios::binary);
  file << "P6\n" << 3 * width << " " << height << "\n255\n";
  for (int y = 0; y < height; ++y) {
    for (const std::vector<glm::u8vec3>* picture : {&a, &b, &std::as_const(apart)}) {
      writeRow(file, &picture->at(std::size_t(y) * std::size_t(width)), width);
    }
  }
}

double relativeL2(const Field& a, const Field& b) { return relativeNorm(difference(a, b, 1.0), b); }

double shapeL2(const Field& a, const Field& b) {
  const double own = product(a, a);
  return relativeNorm(difference(a, b, own > 0.0 ? product(a, b) / own : 0.0), b);
}

double largestDifference(const Field& a, const Field& b) {
  double largest = 0.0;
  const Field d = difference(a, b, 1.0);
  for (const auto& cell : d.cells) {
    for (const Coefficients& c : cell) {
      for (int k = 0; k < 4; ++k) {
        // A NaN must not pass for agreement.
        largest = std::isnan(c[k]) ? std::numeric_limits<double>::infinity() : std::max(largest, std::abs(c[k]));
      }
    }
  }
  return largest;
}

}  // namespace lpv::reference
