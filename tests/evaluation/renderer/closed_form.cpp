#include "renderer/closed_form.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "reference/ground_truth.h"

namespace lpv::evaluation {

namespace {

constexpr std::size_t kMostPieces = 200000;  ///< about 1 ms a receiver
constexpr double kPointBeyond = 16.0;        ///< times the longest edge

/// A triangle's corners with their texture coordinates.
struct Part {
  std::array<glm::dvec3, 3> corners;
  std::array<glm::dvec2, 3> uvs;
};

/// Longest extent in texels.
double texelsAcross(const Part& part, const LinearTexture& texture) {
  double most = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec2 edge = (part.uvs[(i + 1) % 3] - part.uvs[i]) * glm::dvec2(texture.width(), texture.height());
    most = std::max({most, std::abs(edge.x), std::abs(edge.y)});
  }
  return most;
}

std::array<Part, 4> quarters(const Part& p) {
  Part middle;
  for (std::size_t i = 0; i < 3; ++i) {
    middle.corners[i] = 0.5 * (p.corners[i] + p.corners[(i + 1) % 3]);
    middle.uvs[i] = 0.5 * (p.uvs[i] + p.uvs[(i + 1) % 3]);
  }
  std::array<Part, 4> out{middle, middle, middle, middle};
  for (std::size_t i = 0; i < 3; ++i) {  // corner i with the middles of the two edges that meet there
    out[i + 1].corners = {p.corners[i], middle.corners[i], middle.corners[(i + 2) % 3]};
    out[i + 1].uvs = {p.uvs[i], middle.uvs[i], middle.uvs[(i + 2) % 3]};
  }
  return out;
}

/// Mean over the triangle, exact for polynomials of degree 2 (Strang & Fix 1973).
glm::dvec3 meanTexture(const Part& p, const LinearTexture& texture) {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    sum += texture.at((4.0 * p.uvs[i] + p.uvs[(i + 1) % 3] + p.uvs[(i + 2) % 3]) / 6.0);
  }
  return sum / 3.0;
}

}  // namespace

ClosedForm::ClosedForm(const TracedScene& scene) {
  for (const TracedObject& object : scene.objects()) {
    if (!object.emits) continue;
    for (const glm::uvec3& triangle : object.triangles) {
      if (available_) add(object, triangle);
    }
  }
  if (!available_) pieces_.clear();
}

void ClosedForm::add(const TracedObject& object, const glm::uvec3& t) {
  Part whole{{object.positions[t.x], object.positions[t.y], object.positions[t.z]}, {}};
  if (object.texture) whole.uvs = {object.uvs[t.x], object.uvs[t.y], object.uvs[t.z]};
  std::vector<Part> open{whole};
  while (!open.empty()) {
    const Part part = open.back();
    open.pop_back();
    available_ = available_ && pieces_.size() + open.size() < kMostPieces;
    if (!available_) return;
    if (object.texture && texelsAcross(part, *object.texture) > 1.0) {
      const auto smaller = quarters(part);
      open.insert(open.end(), smaller.begin(), smaller.end());
      continue;
    }
    const auto& [a, b, c] = part.corners;
    Piece piece{a, b, c, (a + b + c) / 3.0, 0.5 * glm::cross(b - a, c - a), object.colour, 0.0, object.twoSided};
    if (object.texture) piece.radiance *= meanTexture(part, *object.texture);
    const double longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
    piece.reachSquared = kPointBeyond * kPointBeyond * longest * longest;
    if (longest > 0.0) pieces_.push_back(piece);
  }
}

glm::dvec3 ClosedForm::irradiance(const glm::dvec3& position, const glm::dvec3& normal) const {
  glm::dvec3 sum(0.0);
  for (const Piece& p : pieces_) {
    const glm::dvec3 to = p.centre - position;
    const double squared = glm::dot(to, to);
    const double facing = -glm::dot(p.areaNormal, to);
    if (squared > p.reachSquared) {
      const double cosines =
          std::max(0.0, glm::dot(normal, to)) * (p.twoSided ? std::abs(facing) : std::max(0.0, facing));
      sum += p.radiance * (cosines / (squared * squared));
      continue;
    }
    sum += p.radiance * reference::triangleIrradiance({p.a, p.b, p.c}, position, normal);
    if (p.twoSided) sum += p.radiance * reference::triangleIrradiance({p.a, p.c, p.b}, position, normal);
  }
  return sum;
}

}  // namespace lpv::evaluation
