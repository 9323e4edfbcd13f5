#include "reference/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "reference/emitter.h"
#include "reference/sh.h"
#include "reference/texel.h"
#include "reference/volume.h"

namespace lpv::reference {
namespace {

/// A light or a surface: exactly one pointer is set.
struct Object {
  const Light* light;
  const Surface* surface;
  glm::dvec3 emitted{0.0};

  bool twoSided() const { return light ? light->twoSided : surface->twoSided; }
};

/// One world triangle with what shading needs.
struct Facet {
  std::size_t object;
  bool seenFromBehind;
  std::array<glm::dvec3, 3> corners{};  ///< counter-clockwise seen from the front
  std::array<glm::dvec3, 3> normals{};
  std::array<glm::dvec2, 3> uvs{};
};

struct Hit {
  double depth = std::numeric_limits<double>::infinity();
  const Facet* facet = nullptr;
  glm::dvec3 weights{0.0};  ///< barycentric
  bool front = true;
};

/// The ray's crossing of a triangle (Moeller & Trumbore 1997); depth in lengths of `direction`.
std::optional<Hit> intersect(const Facet& f, const glm::dvec3& origin, const glm::dvec3& direction) {
  const glm::dvec3 ab = f.corners[1] - f.corners[0];
  const glm::dvec3 ac = f.corners[2] - f.corners[0];
  const glm::dvec3 normal = glm::cross(ab, ac);
  const double facing = -glm::dot(direction, normal);
  if (facing == 0.0 || (facing < 0.0 && !f.seenFromBehind)) return std::nullopt;
  const glm::dvec3 from = origin - f.corners[0];
  const glm::dvec3 turned = glm::cross(from, direction);
  const double v = glm::dot(ac, turned) / facing;
  const double w = -glm::dot(ab, turned) / facing;
  if (v < 0.0 || w < 0.0 || v + w > 1.0) return std::nullopt;
  return Hit{glm::dot(from, normal) / facing, &f, {1.0 - v - w, v, w}, facing > 0.0};
}

/// Weighted mean of a facet's three values.
template <typename Value>
Value mix(const std::array<Value, 3>& values, const glm::dvec3& weights) {
  return weights.x * values[0] + weights.y * values[1] + weights.z * values[2];
}

/// Directions of a picture's rays, unit length along the view, so that ray lengths are depths.
class Rays {
 public:
  Rays(const Camera& camera, int width, int height) : width_(width), height_(height) {
    forward_ = glm::normalize(camera.target - camera.eye);
    right_ = glm::normalize(glm::cross(forward_, camera.up));
    above_ = glm::cross(right_, forward_);
    halfHeight_ = std::tan(camera.fovDegrees * pi() / 360.0);
  }

  glm::dvec3 through(int x, int y) const {
    const double u = (x + 0.5) / width_;
    const double v = (y + 0.5) / height_;
    const double halfWidth = halfHeight_ * width_ / height_;
    return forward_ + (2.0 * u - 1.0) * halfWidth * right_ + (1.0 - 2.0 * v) * halfHeight_ * above_;
  }

 private:
  int width_;
  int height_;
  glm::dvec3 forward_, right_, above_;
  double halfHeight_;
};

/// Everything a ray can meet, and the light on it.
class Stage {
 public:
  Stage(const Scene& scene, const Volume& volume, const RenderOptions& options)
      : grid_(volume.grid), lookup_(options.lookup) {
    for (std::size_t layer = 0; layer < volume.layers.size(); ++layer) fields_.push_back(fieldOf(volume, layer));
    for (const auto& [name, light] : scene.lights) {
      const bool backs = light->twoSided || options.lightBacksAreOpaque;
      if (light->enabled) addFacets(*light->mesh, light->transform, backs);
      objects_.push_back({light.get(), nullptr, radianceOf(*light)});
    }
    for (const auto& [name, surface] : scene.surfaces) {
      addFacets(*surface->mesh, surface->transform, surface->twoSided);
      objects_.push_back({nullptr, surface.get()});
    }
  }

  Hit nearest(const glm::dvec3& eye, const glm::dvec3& direction, double least, double most) const {
    Hit best;
    for (const Facet& facet : facets_) {
      const std::optional<Hit> hit = intersect(facet, eye, direction);
      if (hit && hit->depth >= least && hit->depth <= most && hit->depth < best.depth) best = *hit;
    }
    return best;
  }

  glm::dvec3 normalAt(const Hit& hit) const {
    const glm::dvec3 n = glm::normalize(mix(hit.facet->normals, hit.weights));
    return hit.front ? n : -n;
  }

  glm::dvec3 radianceAt(const Hit& hit) const {
    const Object& object = objects_[hit.facet->object];
    const Texture* texture = (object.light ? object.light->texture : object.surface->albedoTexture).get();
    const glm::dvec3 tint = texture ? bilinear(*texture, mix(hit.facet->uvs, hit.weights)) : glm::dvec3(1.0);
    if (object.light) return hit.front || object.twoSided() ? object.emitted * tint : glm::dvec3(0.0);
    const glm::dvec3 e = irradiance(mix(hit.facet->corners, hit.weights), normalAt(hit));
    return object.surface->albedo * tint * e / pi();
  }

 private:
  void addFacets(const Mesh& mesh, const Transform& transform, bool seenFromBehind) {
    const glm::dmat4 world = worldFromObject(transform);
    const glm::dmat3 linear(world);
    const glm::dmat3 normalMatrix = glm::transpose(glm::inverse(linear));
    const bool mirrored = glm::determinant(linear) < 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
      Facet f{objects_.size(), seenFromBehind};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = t[mirrored && k > 0 ? int(3 - k) : int(k)];
        f.corners[k] = glm::dvec3(world * glm::dvec4(glm::dvec3(mesh.positions[vertex]), 1.0));
        if (!mesh.normals.empty()) f.normals[k] = glm::normalize(normalMatrix * glm::dvec3(mesh.normals[vertex]));
        if (!mesh.uvs.empty()) f.uvs[k] = glm::dvec2(mesh.uvs[vertex]);
      }
      const glm::dvec3 area = glm::cross(f.corners[1] - f.corners[0], f.corners[2] - f.corners[0]);
      if (area == glm::dvec3(0.0)) continue;
      if (mesh.normals.empty()) f.normals.fill(glm::normalize(area));
      facets_.push_back(f);
    }
  }

  glm::dvec3 irradiance(const glm::dvec3& p, const glm::dvec3& n) const {
    glm::dvec3 sum(0.0);
    for (const Field& field : fields_) sum += lookup(grid_, field, lookup_, p, n).value_or(glm::dvec3(0.0));
    return sum;
  }

  Grid grid_;
  Lookup lookup_;
  std::vector<Field> fields_;
  std::vector<Object> objects_;
  std::vector<Facet> facets_;
};

/// True when two neighbouring pixels show one smooth piece of one object.
bool continues(const Seen& a, const Seen& b) {
  constexpr double kJump = 0.05;    // share of the depth
  constexpr double kCrease = 0.95;  // cosine between normals
  if (a.object != b.object) return false;
  if (a.object < 0) return true;
  return std::abs(a.depth - b.depth) <= kJump * std::min(a.depth, b.depth) && glm::dot(a.normal, b.normal) >= kCrease;
}

}  // namespace

Picture render(const Scene& scene, const Volume& volume, const Camera& camera, const RenderOptions& options) {
  const Stage stage(scene, volume, options);
  const Rays rays(camera, options.width, options.height);
  Picture picture{options.width, options.height, {}, {}};
  for (int y = 0; y < options.height; ++y) {
    for (int x = 0; x < options.width; ++x) {
      const Hit hit = stage.nearest(camera.eye, rays.through(x, y), camera.near, camera.far);
      picture.radiance.push_back(hit.facet ? stage.radianceAt(hit) : glm::dvec3(0.0));
      picture.seen.push_back(hit.facet ? Seen{int(hit.facet->object), hit.depth, stage.normalAt(hit)} : Seen{});
    }
  }
  return picture;
}

std::vector<bool> interiorOf(const Picture& picture) {
  std::vector<bool> interior(picture.seen.size(), true);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const Seen& here = picture.seen[picture.index(x, y)];
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, picture.height - 1); ++v) {
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, picture.width - 1); ++u) {
          if (!continues(here, picture.seen[picture.index(u, v)])) interior[picture.index(x, y)] = false;
        }
      }
    }
  }
  return interior;
}

}  // namespace lpv::reference
