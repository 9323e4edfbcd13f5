#include "scene/workload.h"

#include <algorithm>
#include <cmath>
#include <glm/gtx/component_wise.hpp>

#include "scene/distant_lights.h"

namespace lpv {
namespace {

/// VPLs that one cell makes of a surface that passes through it: a few directions, seen in statues.
constexpr double kVplsPerCell = 12.0;
/// A tree's entries per VPL.
constexpr double kEntriesPerVpl = 1.5;
constexpr double kSameColour = 1e-3;

/// Area in the world is at most this many times that in object space.
double areaScale(const Transform& transform) {
  glm::dvec3 s = glm::abs(transform.scale);
  return s.x * s.y * s.z / std::max(glm::compMin(s), 1e-300);
}

}  // namespace

Workload::Workload(const LightingSettings& options, const Grid& grid)
    : transport(options.transport),
      iterations(options.iterationsFor(grid)),
      cells(double(grid.cells())),
      gridFromWorld_(1.0 / grid.cell),
      face_(double(glm::compMax(grid.dims)) * glm::compMax(grid.dims)),
      groupsItself_(options.groupsItself()) {}

bool Workload::automatic() const {
  return groupsItself_ && groups_.size() < 2 && (groups_.empty() || groups_.begin()->empty());
}

int Workload::groups() const {
  return automatic() ? std::clamp(int(lights), 1, kMaxGroups) : std::max(1, int(groups_.size()));
}

void Workload::countMesh(const Mesh& mesh) { bytes += double(mesh.bytes()); }

/// Lights of one chromaticity share a channel; with a texture, or a fourth one, there are red, green and blue.
void Workload::countColour(const glm::dvec3& radiance) {
  const double brightest = glm::compMax(radiance);
  if (brightest <= 0.0 || colours_.size() == 3) return;
  const glm::dvec3 colour = radiance / brightest;
  const bool known = std::any_of(colours_.begin(), colours_.end(),
                                 [&](const glm::dvec3& c) { return glm::compMax(glm::abs(c - colour)) < kSameColour; });
  if (!known) colours_.push_back(colour);
}

/// In parts, whose cells go by their size, not by the grid's.
void Workload::addDistant() {
  constexpr double kEntries = 3000.0;  // of an eighth of the sky, an estimate: 28^2 cells, bent
  lights += double(kMostDistantParts);
  rootsOfEntries += double(kMostDistantParts) * std::sqrt(kEntries);
  columns += double(kMostDistantParts) * kEntries;
}

void Workload::add(const Light& light) {
  if (!light.enabled) return;
  const double triangles = double(light.mesh->triangles.size());
  const double area = light.mesh->area * areaScale(light.transform) * gridFromWorld_ * gridFromWorld_;
  const double met = std::min(area, 2.0 * triangles * face_);
  const double vpls = std::min({3.0 * triangles + 3.0 * met, kVplsPerCell * (1.0 + met), kVplsPerCell * cells});
  lightTriangles += triangles;
  if (light.distant) {
    addDistant();
  } else {
    lights += 1.0;
    columns += met;
    litCells += std::min(cells, 3.0 * met + triangles);
    rootsOfEntries += std::sqrt(kEntriesPerVpl * vpls);
  }
  countMesh(*light.mesh);
  if (light.texture != nullptr) {
    bytes += 16.0 * double(light.texture->width) * double(light.texture->height);
    colours_ = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  }
  countColour(light.power ? *light.power : light.radiance);
  groups_.insert(light.group);
}

void Workload::add(const Surface& surface) {
  countMesh(*surface.mesh);
  for (const TexturePtr& texture : texturesOf(surface))
    if (texture != nullptr) bytes += 4.0 * double(texture->width) * double(texture->height);
}

}  // namespace lpv
