#include "scene/gloss.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace lpv {

namespace {

constexpr glm::ivec2 kTableSamples(8, 64);

double fresnelEdge(double cosine) { return std::pow(1.0 - std::clamp(cosine, 0.0, 1.0), 5.0); }

/// Of Smith's masking function, for a direction with that cosine.
double lambdaOf(double cosine, double alpha) {
  const double tangent2 = (1.0 - cosine * cosine) / (cosine * cosine);
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * std::max(tangent2, 0.0)) - 1.0);
}

/// Density of facets with the normal h, of GGX.
double facetsAbout(const glm::dvec3& n, const glm::dvec3& h, double alpha) {
  const double nh = glm::dot(n, h), a2 = alpha * alpha;
  const glm::dvec3 across = glm::cross(n, h);
  const double below = a2 * nh * nh + glm::dot(across, across);
  return a2 / (glm::pi<double>() * below * below);
}

/// A facet's normal about z, of those that are seen from v (Dupuy and Benyoub 2023). u in [0, 1)^2.
glm::dvec3 seenFacet(const glm::dvec3& v, double alpha, const glm::dvec2& u) {
  const glm::dvec3 stretched = glm::normalize(glm::dvec3(alpha * v.x, alpha * v.y, v.z));
  const double turn = 2.0 * glm::pi<double>() * u.x, z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
  const double across = std::sqrt(std::clamp(1.0 - z * z, 0.0, 1.0));
  const glm::dvec3 h = glm::dvec3(across * std::cos(turn), across * std::sin(turn), z) + stretched;
  return glm::normalize(glm::dvec3(alpha * h.x, alpha * h.y, std::max(h.z, 0.0)));
}

}  // namespace

bool isGlossy(const Surface& surface) {
  return surface.metalness > 0.0 || surface.roughness < 1.0 || surface.glossTexture != nullptr;
}

bool showsGloss(const Scene& scene) {
  if (scene.options.gloss != Gloss::kOn || scene.options.transport == Transport::kPropagate) return false;
  return std::ranges::any_of(
      scene.surfaces, [](const auto& entry) { return entry.second->visibleToCamera && isGlossy(*entry.second); });
}

GlossLobe GlossLobe::of(const glm::dvec3& albedo, double roughness, double metalness) {
  return {glm::mix(glm::dvec3(kDielectricReflectance), albedo, metalness),
          std::max(roughness * roughness, kLeastAlpha)};
}

glm::dvec3 GlossLobe::single(const glm::dvec3& n, const glm::dvec3& v, const glm::dvec3& l) const {
  const double nv = glm::dot(n, v), nl = glm::dot(n, l);
  if (nv <= 0.0 || nl <= 0.0) return glm::dvec3(0.0);
  const glm::dvec3 h = glm::normalize(v + l);
  const double facets = facetsAbout(n, h, alpha);
  const double both = 1.0 / (1.0 + lambdaOf(nv, alpha) + lambdaOf(nl, alpha));
  const glm::dvec3 fresnel = straight + (1.0 - straight) * fresnelEdge(glm::dot(v, h));
  return fresnel * (facets * both / (4.0 * nv * nl));
}

glm::dvec3 GlossLobe::direction(const glm::dvec3& n, const glm::dvec3& v, const glm::dvec2& u) const {
  const glm::dvec3 side = std::abs(n.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
  const glm::dvec3 right = glm::normalize(glm::cross(n, side)), up = glm::cross(n, right);
  const glm::dvec3 h = seenFacet({glm::dot(v, right), glm::dot(v, up), glm::dot(v, n)}, alpha, u);
  return glm::reflect(-v, h.x * right + h.y * up + h.z * n);
}

double GlossLobe::density(const glm::dvec3& n, const glm::dvec3& v, const glm::dvec3& l) const {
  const double nv = glm::dot(n, v);
  if (nv <= 0.0) return 0.0;
  return facetsAbout(n, glm::normalize(v + l), alpha) / ((1.0 + lambdaOf(nv, alpha)) * 4.0 * nv);
}

glm::dvec3 GlossShare::gain(const glm::dvec3& reflectance) const {
  return 1.0 + reflectance * ((1.0 - all()) / std::max(all(), 1e-6));
}

glm::dvec3 GlossShare::of(const glm::dvec3& reflectance) const {
  return glm::min((reflectance * straight + edge) * gain(reflectance), glm::dvec3(1.0));
}

GlossShare glossShare(double mu, double alpha, const glm::ivec2& samples) {
  const glm::dvec3 v(std::sqrt(std::max(1.0 - mu * mu, 0.0)), 0.0, mu);
  const double lambda = lambdaOf(mu, alpha);
  GlossShare sum;  // of the half on one side of v
  const int count = samples.x * samples.y;
  for (int i = 0; i < count; ++i) {
    const glm::dvec2 u = (glm::dvec2(i % samples.x, i / samples.x) + 0.5) / glm::dvec2(samples);
    const glm::dvec3 h = seenFacet(v, alpha, {0.5 * u.x, u.y}), l = 2.0 * glm::dot(v, h) * h - v;
    if (l.z <= 0.0) continue;
    const double weight = (1.0 + lambda) / (1.0 + lambda + lambdaOf(l.z, alpha)), edge = fresnelEdge(glm::dot(v, h));
    sum.straight += (1.0 - edge) * weight;
    sum.edge += edge * weight;
  }
  return {sum.straight / count, sum.edge / count};
}

const std::vector<glm::vec2>& glossTable() {
  static const std::vector<glm::vec2> table = [] {
    std::vector<glm::vec2> out;
    for (int row = 0; row < kGlossTable; ++row) {
      const double roughness = (row + 0.5) / kGlossTable, alpha = std::max(roughness * roughness, kLeastAlpha);
      for (int column = 0; column < kGlossTable; ++column) {
        const GlossShare share = glossShare((column + 0.5) / kGlossTable, alpha, kTableSamples);
        out.emplace_back(share.straight, share.edge);
      }
    }
    return out;
  }();
  return table;
}

}  // namespace lpv
