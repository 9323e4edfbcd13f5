#include "scene/distant_lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "base/mutex.h"
#include "scene/coarse_texture.h"

namespace lpv {

namespace {

constexpr int kSkyColumns = 64;
constexpr int kSkyRows = 32;
/// Mean square of how far directions of a part may be from their mean, unit vectors: a part 25 degrees across is left
/// whole.
constexpr double kAlike = 0.03;
constexpr int kBoxesOfPicture = 512;
constexpr std::size_t kMostCut = 65'536;  ///< triangles; meshes of more stay whole: sorting a million takes seconds

/// A triangle as it counts: where it is seen, and its share of the mesh, half by area and half by power.
struct SeenTriangle {
  glm::uvec3 triangle;
  glm::dvec3 direction{0.0};
  double weight = 0.0;
};
using SeenTriangles = std::vector<SeenTriangle>;

glm::dvec3 cornerOf(const Mesh& mesh, std::uint32_t i) { return {mesh.positions[i]}; }

double areaOfTriangle(const Mesh& mesh, const glm::uvec3& t) {
  const glm::dvec3 a = cornerOf(mesh, t.x);
  return 0.5 * glm::length(glm::cross(cornerOf(mesh, t.y) - a, cornerOf(mesh, t.z) - a));
}

/// Brightness of the picture over the triangle: the mean at 15 points.
double brightnessOf(const Mesh& mesh, const glm::uvec3& t, const CoarseTexture& picture) {
  constexpr int kSteps = 4;
  double sum = 0.0;
  int points = 0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps - i; ++j, ++points) {
      const double y = (i + 1.0 / 3.0) / (kSteps + 1.0), z = (j + 1.0 / 3.0) / (kSteps + 1.0);
      const glm::vec3 colour = picture.at((1.0 - y - z) * glm::dvec2(mesh.uvs[t.x]) + y * glm::dvec2(mesh.uvs[t.y]) +
                                          z * glm::dvec2(mesh.uvs[t.z]));
      sum += double(colour.x + colour.y + colour.z);
    }
  }
  return sum / points;
}

SeenTriangles seenTriangles(const Mesh& mesh, const CoarseTexture* picture, const DistantShape& shape) {
  SeenTriangles out;
  double area = 0.0, power = 0.0;
  std::vector<double> powers;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 inMesh = (cornerOf(mesh, t.x) + cornerOf(mesh, t.y) + cornerOf(mesh, t.z)) / 3.0;
    const glm::dvec3 middle = shape.scale * inMesh + shape.offset;
    const double length = glm::length(middle), size = areaOfTriangle(mesh, t);
    out.push_back({t, length > 0.0 ? middle / length : glm::dvec3(0.0), size});
    powers.push_back(size * (picture != nullptr ? brightnessOf(mesh, t, *picture) : 1.0));
    area += size;
    power += powers.back();
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].weight = 0.5 * out[i].weight / std::max(area, 1e-300) + 0.5 * powers[i] / std::max(power, 1e-300);
  }
  return out;
}

/// Sums over triangles, of which the spread of their directions follows.
struct DirectionMoments {
  double weight = 0.0;
  glm::dvec3 sum{0.0};

  void add(const SeenTriangle& t) {
    weight += t.weight;
    sum += t.weight * t.direction;
  }
  /// Weight times the mean square of the distance from the mean.
  double spread() const { return weight > 0.0 ? weight - glm::dot(sum, sum) / weight : 0.0; }
};

DirectionMoments directionMomentsOf(std::span<const SeenTriangle> part) {
  DirectionMoments out;
  for (const SeenTriangle& t : part) out.add(t);
  return out;
}

/// Sorts the part so that halving it at the place that is returned leaves the least spread.
std::size_t halve(std::span<SeenTriangle> part) {
  const DirectionMoments all = directionMomentsOf(part);
  double least = all.spread();
  std::size_t best = 0;
  int bestAxis = 0;
  const auto sortBy = [part](int axis) {
    std::ranges::stable_sort(part, {}, [axis](const SeenTriangle& t) { return t.direction[axis]; });
  };
  for (int axis = 0; axis < 3; ++axis) {
    sortBy(axis);
    DirectionMoments before;
    for (std::size_t i = 0; i + 1 < part.size(); ++i) {
      before.add(part[i]);
      if (part[i].direction[axis] == part[i + 1].direction[axis]) continue;
      const DirectionMoments after = {all.weight - before.weight, all.sum - before.sum};
      const double spread = before.spread() + after.spread();
      if (spread >= least) continue;
      least = spread;
      best = i + 1;
      bestAxis = axis;
    }
  }
  sortBy(bestAxis);
  return best;
}

std::vector<std::span<SeenTriangle>> halved(SeenTriangles& triangles) {
  std::vector<std::span<SeenTriangle>> parts = {triangles};
  while (parts.size() < kMostDistantParts && triangles.size() <= kMostCut) {
    const auto spreadOf = [](std::span<const SeenTriangle> part) {
      const DirectionMoments all = directionMomentsOf(part);
      return all.spread() > kAlike * all.weight ? all.spread() : 0.0;
    };
    const auto widest = std::ranges::max_element(parts, {}, spreadOf);
    if (spreadOf(*widest) <= 0.0) break;
    const std::size_t at = halve(*widest);
    if (at == 0) break;
    const std::span<SeenTriangle> rest = widest->subspan(at);
    *widest = widest->first(at);
    parts.push_back(rest);
  }
  return parts;
}

template <typename T>
void appendIfAny(const std::vector<T>& from, std::uint32_t at, std::vector<T>& to) {
  if (!from.empty()) to.push_back(from[at]);
}

/// The triangles alone, with the vertices that they have.
MeshPtr meshOf(const Mesh& mesh, std::span<const SeenTriangle> part) {
  auto out = std::make_shared<Mesh>();
  std::map<std::uint32_t, std::uint32_t> moved;
  for (const SeenTriangle& t : part) {
    glm::uvec3 triangle;
    for (int i = 0; i < 3; ++i) {
      const auto [found, isNew] = moved.try_emplace(t.triangle[i], std::uint32_t(out->positions.size()));
      triangle[i] = found->second;
      if (!isNew) continue;
      out->positions.push_back(mesh.positions[t.triangle[i]]);
      appendIfAny(mesh.normals, t.triangle[i], out->normals);
      appendIfAny(mesh.uvs, t.triangle[i], out->uvs);
      appendIfAny(mesh.directions, t.triangle[i], out->directions);
    }
    out->triangles.push_back(triangle);
  }
  (void)finishMesh(*out);  // of a mesh that has passed it
  return out;
}

std::vector<DistantPart> partsOf(const Mesh& mesh, const TexturePtr& texture, const DistantShape& shape) {
  std::optional<CoarseTexture> picture;
  if (texture != nullptr && !mesh.uvs.empty()) picture.emplace(*texture, std::vector<float>(), kBoxesOfPicture);
  const CoarseTexture* seen = picture ? &*picture : nullptr;
  SeenTriangles triangles = seenTriangles(mesh, seen, shape);
  std::vector<DistantPart> out;
  for (const std::span<SeenTriangle> part : halved(triangles)) {
    MeshPtr made = meshOf(mesh, part);
    auto points = std::make_shared<const LightPoints>(lightPointsByPower(*made, seen));
    if (made->area > 0.0) out.push_back({std::move(made), std::move(points)});
  }
  return out;
}

using Parts = std::shared_ptr<const std::vector<DistantPart>>;

/// Of all sessions, while their lights have them.
class KnownParts {
 public:
  Parts find(const MeshPtr& mesh, const TexturePtr& texture, const DistantShape& shape) LPV_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    const auto found = known_.find({mesh, texture, shape});
    return found == known_.end() ? nullptr : found->second.lock();
  }
  void keep(const MeshPtr& mesh, const TexturePtr& texture, const DistantShape& shape, const Parts& parts)
      LPV_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    std::erase_if(known_, [](const auto& entry) { return entry.second.expired(); });
    known_[{mesh, texture, shape}] = parts;
  }

 private:
  /// By owner, so that an address that is given again is another one.
  struct Key {
    std::weak_ptr<const Mesh> mesh;
    std::weak_ptr<const Texture> texture;
    DistantShape shape;
    bool operator<(const Key& other) const {
      if (mesh.owner_before(other.mesh)) return true;
      if (other.mesh.owner_before(mesh)) return false;
      if (texture.owner_before(other.texture)) return true;
      if (other.texture.owner_before(texture)) return false;
      const auto numbers = [](const DistantShape& s) {
        return std::array{s.scale.x, s.scale.y, s.scale.z, s.offset.x, s.offset.y, s.offset.z};
      };
      return numbers(shape) < numbers(other.shape);
    }
  };
  Mutex mutex_;
  std::map<Key, std::weak_ptr<const std::vector<DistantPart>>> known_ LPV_GUARDED_BY(mutex_);
};

/// Each keeps all parts, so that these stay known while one of them is used: by its points, since what is known of
/// meshes elsewhere goes by their owners (scene/emitter_tree.cpp).
std::vector<LightPtr> partsAround(const LightPtr& light, const Grid& grid) {
  const Transform& given = light->transform;
  const DistantShape shape = {given.scale, glm::inverse(given.rotation) * given.translation};
  const Parts parts = distantParts(light->mesh, light->texture, shape);
  const Transform transform = placedAround(grid, light->transform);
  std::vector<LightPtr> out;
  for (std::size_t i = 0; i < parts->size(); ++i) {
    auto part = std::make_shared<Light>(*light);
    part->name = light->name + "/" + std::to_string(i + 1);
    part->mesh = (*parts)[i].mesh;
    part->points = LightPointsPtr(parts, (*parts)[i].points.get());
    part->transform = transform;
    part->castsShadow = false;
    part->radiance = emittedRadiance(*light);
    part->power.reset();
    part->placedFrom = light;
    out.push_back(std::move(part));
  }
  return out;
}

}  // namespace

Mesh skyMesh() {
  Mesh mesh;
  const auto vertex = [&mesh](double u, double v) {
    const double azimuth = 2.0 * std::numbers::pi * (u - 0.5), polar = std::numbers::pi * v;
    mesh.positions.emplace_back(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                std::sin(polar) * std::sin(azimuth));
    mesh.uvs.emplace_back(u, v);
    return std::uint32_t(mesh.positions.size() - 1);
  };
  // Each column of a pole has a vertex there of its own, in the middle of its texels.
  std::array<std::array<std::uint32_t, kSkyColumns + 1>, kSkyRows + 1> at{};
  for (int row = 0; row <= kSkyRows; ++row) {
    const bool pole = row == 0 || row == kSkyRows;
    for (int column = 0; column <= kSkyColumns - (pole ? 1 : 0); ++column)
      at[std::size_t(row)][std::size_t(column)] =
          vertex((column + (pole ? 0.5 : 0.0)) / kSkyColumns, double(row) / kSkyRows);
  }
  for (std::size_t row = 0; row < kSkyRows; ++row) {
    for (std::size_t column = 0; column < kSkyColumns; ++column) {
      const std::uint32_t above = at[row][column], below = at[row + 1][column];
      if (row + 1 < kSkyRows) mesh.triangles.emplace_back(above, below, at[row + 1][column + 1]);
      if (row > 0)
        mesh.triangles.emplace_back(above, row + 1 < kSkyRows ? at[row + 1][column + 1] : below, at[row][column + 1]);
    }
  }
  return mesh;
}

Parts distantParts(const MeshPtr& mesh, const TexturePtr& texture, const DistantShape& shape) {
  static KnownParts known;
  if (Parts parts = known.find(mesh, texture, shape)) return parts;
  auto parts = std::make_shared<const std::vector<DistantPart>>(partsOf(*mesh, texture, shape));
  known.keep(mesh, texture, shape, parts);
  return parts;
}

Transform placedAround(const Grid& grid, const Transform& given) {
  const Bounds box = grid.bounds();
  const double distance = kDistance * 0.5 * glm::length(box.extent());
  return {box.centre() + distance * given.translation, given.rotation, distance * given.scale};
}

void placeDistantLights(std::map<std::string, LightPtr>& lights, const Grid& grid) {
  std::vector<LightPtr> anew;
  for (const auto& [name, light] : lights) {
    if (!light->distant) continue;
    const LightPtr& source = light->placedFrom != nullptr ? light->placedFrom : light;
    const bool stands = light->placedFrom != nullptr && light->transform == placedAround(grid, source->transform);
    if (!stands && (anew.empty() || anew.back() != source)) anew.push_back(source);
  }
  for (const LightPtr& source : anew) {
    eraseParts(lights, source->name);
    lights.erase(source->name);
    for (const LightPtr& part : partsAround(source, grid)) lights.insert_or_assign(part->name, part);
  }
}

void eraseParts(std::map<std::string, LightPtr>& lights, const std::string& name) {
  lights.erase(lights.lower_bound(name + '/'), lights.lower_bound(name + char('/' + 1)));
}

}  // namespace lpv
