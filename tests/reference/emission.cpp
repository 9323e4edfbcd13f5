#include "reference/emission.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "reference/sh.h"

namespace lpv::reference {
namespace {

using Triangle = std::array<glm::dvec3, 3>;  // barycentric corners

/// A part on which the texture is one bilinear function: that of the texels right of and below (x, y).
struct Piece {
  Polygon polygon;
  std::int64_t x = 0;
  std::int64_t y = 0;
};

/// Texture coordinates in texels from the centre of texel (0, 0).
glm::dvec2 texelAt(const Emitter& e, const glm::dvec3& b) {
  const MipLevel& level = e.texture->levels[0];
  return e.uvAt(b) * glm::dvec2(level.width, level.height) - 0.5;
}

/// The polygon's strips between the lines `texelAt[axis]` = whole number, as pairs of number and strip.
std::vector<std::pair<std::int64_t, Polygon>> strips(const Emitter& e, const Polygon& polygon, int axis) {
  std::vector<std::pair<std::int64_t, Polygon>> out;
  if (polygon.size() < 3) return out;
  double least = texelAt(e, polygon[0])[axis];
  double most = least;
  for (const glm::dvec3& b : polygon) {
    least = std::min(least, texelAt(e, b)[axis]);
    most = std::max(most, texelAt(e, b)[axis]);
  }
  const auto last = std::max(std::int64_t(std::ceil(most)), std::int64_t(std::floor(least)) + 1);
  for (auto i = std::int64_t(std::floor(least)); i < last; ++i) {
    const Polygon above = clip(polygon, [&](const glm::dvec3& b) { return texelAt(e, b)[axis] - double(i); });
    out.emplace_back(i, clip(above, [&](const glm::dvec3& b) { return double(i + 1) - texelAt(e, b)[axis]; }));
  }
  return out;
}

std::vector<Piece> piecesOf(const Emitter& e, const Polygon& part) {
  if (!e.texture) return {{part}};
  std::vector<Piece> pieces;
  for (const auto& [y, row] : strips(e, part, 1)) {
    for (const auto& [x, polygon] : strips(e, row, 0)) {
      if (polygon.size() >= 3) pieces.push_back({polygon, x, y});
    }
  }
  return pieces;
}

/// Radiance times texture at a point of a piece.
glm::dvec3 radianceAt(const Emitter& e, const Piece& piece, const glm::dvec3& b) {
  if (!e.texture) return e.radiance;
  const MipLevel& level = e.texture->levels[0];
  const glm::dvec2 f = texelAt(e, b) - glm::dvec2(piece.x, piece.y);
  const glm::dvec3 upper = (1.0 - f.x) * level.at(piece.x, piece.y) + f.x * level.at(piece.x + 1, piece.y);
  const glm::dvec3 lower = (1.0 - f.x) * level.at(piece.x, piece.y + 1) + f.x * level.at(piece.x + 1, piece.y + 1);
  return e.radiance * ((1.0 - f.y) * upper + f.y * lower);
}

/// The largest colour of the texels that a piece lies between.
double brightestOf(const Emitter& e, const Piece& piece) {
  double brightest = 0.0;
  for (const glm::ivec2 corner : {glm::ivec2(0, 0), glm::ivec2(1, 0), glm::ivec2(0, 1), glm::ivec2(1, 1)}) {
    glm::dvec3 c = e.radiance;
    if (e.texture) c *= e.texture->levels[0].at(piece.x + corner.x, piece.y + corner.y);
    brightest = std::max({brightest, c.x, c.y, c.z});
  }
  return brightest;
}

// --- directions ---

constexpr double kTolerance = 1e-11;  // of the triangle's area, and of that times the brightest texel
constexpr int kDeepest = 16;
constexpr std::array<int, 3> kRules = {3, 5, 7};  // nodes per axis

DirectedEmission& operator+=(DirectedEmission& a, const DirectedEmission& b) {
  a.direction += b.direction;
  for (std::size_t c = 0; c < 3; ++c) a.radiance[c] += b.radiance[c];
  return a;
}

/// Integrals over the triangle, as shares of the whole emitter's area, by n^2 Gauss-Legendre nodes (s, t) in the
/// paper's coordinates for samples (eq. 2, s = sqrt r1): b = (1-s) A + s (1-t) B + s t C, dA = 2 s ds dt. Exact to
/// degree 2n - 2.
DirectedEmission byRule(const Emitter& e, const Piece& piece, const Triangle& triangle, std::size_t rule) {
  static const std::array rules = {gaussLegendre(kRules[0]), gaussLegendre(kRules[1]), gaussLegendre(kRules[2])};
  const double fraction = fractionOf(triangle);
  DirectedEmission sum;
  for (const auto& [s, ws] : rules[rule]) {
    for (const auto& [t, wt] : rules[rule]) {
      const glm::dvec3 b = (1.0 - s) * triangle[0] + s * (1.0 - t) * triangle[1] + s * t * triangle[2];
      const glm::dvec3 amount = (2.0 * s * ws * wt * fraction) * e.directionAt(b);
      const glm::dvec3 radiance = radianceAt(e, piece, b);
      sum.direction += amount;
      for (int c = 0; c < 3; ++c) sum.radiance[std::size_t(c)] += radiance[c] * amount;
    }
  }
  return sum;
}

std::array<Triangle, 4> quartered(const Triangle& t) {
  const glm::dvec3 ab = 0.5 * (t[0] + t[1]);
  const glm::dvec3 bc = 0.5 * (t[1] + t[2]);
  const glm::dvec3 ca = 0.5 * (t[2] + t[0]);
  return {Triangle{t[0], ab, ca}, Triangle{ab, t[1], bc}, Triangle{ca, bc, t[2]}, Triangle{ab, bc, ca}};
}

double distance(const DirectedEmission& a, const DirectedEmission& b, double brightest) {
  double largest = glm::length(a.direction - b.direction);
  for (std::size_t c = 0; c < 3 && brightest > 0.0; ++c) {
    largest = std::max(largest, glm::length(a.radiance[c] - b.radiance[c]) / brightest);
  }
  return largest;
}

/// The first rule that agrees with the one before it; quarters of the triangle where none does.
DirectedEmission integrated(const Emitter& e, const Piece& piece, const Triangle& triangle, double brightest,
                            int depth) {
  DirectedEmission last = byRule(e, piece, triangle, 0);
  for (std::size_t n = 1; n < kRules.size(); ++n) {
    const DirectedEmission next = byRule(e, piece, triangle, n);
    const bool agreed = distance(last, next, brightest) <= kTolerance;
    last = next;
    if (agreed) return last;
  }
  if (depth == kDeepest) return last;
  DirectedEmission sum;
  for (const Triangle& quarter : quartered(triangle)) sum += integrated(e, piece, quarter, brightest, depth + 1);
  return sum;
}

/// The polygon cut along the line on which the direction stands across the largest change from corner to corner, where
/// that line crosses it: where directions turn over within the triangle, they do so there.
std::vector<Polygon> cutAtTurningLine(const Emitter& e, const Polygon& polygon) {
  const std::array<glm::dvec3, 3>& d = *e.directions;
  glm::dvec3 change = d[1] - d[0];
  for (const glm::dvec3& other : {d[2] - d[1], d[0] - d[2]}) {
    if (glm::length(other) > glm::length(change)) change = other;
  }
  const glm::dvec3 along(glm::dot(change, d[0]), glm::dot(change, d[1]), glm::dot(change, d[2]));
  const auto turned = [&](const glm::dvec3& b) { return glm::dot(along, b) > 0.0; };
  const auto count = std::count_if(polygon.begin(), polygon.end(), turned);
  if (count == 0 || std::size_t(count) == polygon.size()) return {polygon};
  return {clip(polygon, [&](const glm::dvec3& b) { return glm::dot(along, b); }),
          clip(polygon, [&](const glm::dvec3& b) { return -glm::dot(along, b); })};
}

}  // namespace

glm::dvec3 radianceIntegral(const Emitter& e, const Polygon& part) {
  glm::dvec3 sum(0.0);
  for (const Piece& piece : piecesOf(e, part)) {
    for (const Triangle& t : fanOf(piece.polygon)) {
      for (std::size_t k = 0; k < 3; ++k) {  // the midpoints of the sides: exact to degree 2
        sum += fractionOf(t) / 3.0 * radianceAt(e, piece, 0.5 * (t[k] + t[(k + 1) % 3]));
      }
    }
  }
  return e.area() * sum;
}

Glow glowIntegral(const Emitter& e, const Polygon& part) {
  static const auto nodes = gaussLegendre(3);  // exact to degree 4: a bilinear texture times a square
  Glow glow;
  for (const Piece& piece : piecesOf(e, part)) {
    for (const Triangle& triangle : fanOf(piece.polygon)) {
      for (const auto& [s, ws] : nodes) {
        for (const auto& [t, wt] : nodes) {
          const glm::dvec3 b = (1.0 - s) * triangle[0] + s * (1.0 - t) * triangle[1] + s * t * triangle[2];
          const glm::dvec3 radiance = radianceAt(e, piece, b), at = e.positionAt(b);
          const double amount = 2.0 * s * ws * wt * fractionOf(triangle) * (radiance.x + radiance.y + radiance.z);
          glow.amount += amount;
          glow.first += amount * at;
          glow.second += amount * glm::outerProduct(at, at);
        }
      }
    }
  }
  glow.amount *= e.area();
  glow.first *= e.area();
  glow.second *= e.area();
  return glow;
}

DirectedEmission directedIntegral(const Emitter& e, const Polygon& part) {
  DirectedEmission sum;
  if (!e.directions) {
    const glm::dvec3 radiance = radianceIntegral(e, part);
    sum.direction = measure(part).fraction * e.areaNormal();
    for (std::size_t c = 0; c < 3; ++c) sum.radiance[c] = radiance[int(c)] * e.normal();
    return sum;
  }
  for (const Piece& piece : piecesOf(e, part)) {
    const double brightest = brightestOf(e, piece);
    for (const Polygon& side : cutAtTurningLine(e, piece.polygon)) {
      for (const Triangle& t : fanOf(side)) {
        sum += integrated(e, piece, t, brightest, 0);
      }
    }
  }
  sum.direction *= e.area();
  for (glm::dvec3& r : sum.radiance) r *= e.area();
  return sum;
}

}  // namespace lpv::reference
