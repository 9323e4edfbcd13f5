#include "lpv/tick_report.h"

#include <algorithm>
#include <memory>
#include <set>
#include <string>

namespace lpv {

namespace {

const char* methodName(InjectionMethod method) {
  switch (method) {
    case InjectionMethod::kRaster:
      return "raster";
    case InjectionMethod::kDense:
      return "dense";
    case InjectionMethod::kCompute:
      break;
  }
  return "compute";
}

const char* transportName(Transport transport) {
  switch (transport) {
    case Transport::kGather:
      return "gather";
    case Transport::kDirect:
      return "direct";
    case Transport::kPropagate:
    case Transport::kAuto:
      break;
  }
  return "propagate";
}

/// Compiled variants that the lights needed.
std::set<std::string> lightFeatures(const SessionState& session) {
  std::set<std::string> features;
  for (std::size_t i = 0; i < session.lights.size(); ++i) {
    if (session.lights[i].twoSided) features.insert("two-sided");
    if (session.voxels[i]->source.textured()) features.insert("textures");
    if (session.voxels[i]->source.directed()) features.insert("directions");
  }
  return features;
}

std::vector<std::string> featuresOf(const SessionState& session, const LightingSettings& options) {
  std::vector<std::string> features = {options.injection == Injection::kFlux ? "flux" : "count",
                                       methodName(options.method), transportName(options.transport),
                                       session.palette().channels == 1 ? "monochrome" : "colour"};
  const std::size_t groups = session.arranged.product().groups.size();
  if (session.sectors != Sectors::kNone) {
    features.emplace_back("layers by direction");
  } else if (groups > 1) {
    features.push_back(std::to_string(groups) + " groups");
  }
  if (options.clampFaces) features.emplace_back("clamp-faces");
  for (const std::string& feature : lightFeatures(session)) features.push_back(feature);
  return features;
}

template <typename Resource>
std::int64_t bytesOf(const std::shared_ptr<Resource>& resource) {
  return resource == nullptr ? 0 : std::int64_t(resource->size());
}

std::int64_t bytesOf(const SceneResources& resources) {
  std::int64_t sum = 0;
  for (const auto& [source, mesh] : resources.meshes)
    sum += bytesOf(mesh->positions) + bytesOf(mesh->normals) + bytesOf(mesh->uvs) + bytesOf(mesh->directions) +
           bytesOf(mesh->triangles) + bytesOf(mesh->merged);
  for (const auto& [source, texture] : resources.textures) sum += std::int64_t(texture->bytes());
  for (const auto& [source, light] : resources.lightTextures)
    sum += std::int64_t(light->radiance.bytes() + light->rowIntegrals.size() + light->rowMoments.size());
  return sum;
}

}  // namespace

void fillReport(const SessionState& session, const LightingSettings& options, const layout::Counters& counts,
                TickReport& report) {
  report.memory = {session.lightMemory->bytes, session.frameMemory->bytes, bytesOf(session.resources)};
  report.features = featuresOf(session, options);
  report.trianglesSkipped = counts.degenerate;
  report.touchedCells = counts.touched;
  report.clampedCells = counts.clamped;
  for (const LightVoxelsPtr& voxels : session.voxels) {
    report.fixedPointError = std::max(report.fixedPointError, voxels->roundingError);
    if (voxels->tree == nullptr || !voxels->ready()) continue;
    report.trianglesSkipped += voxels->tree->degenerate;
    report.touchedCells += voxels->tree->cellCount;
    report.vpls += voxels->tree->vplCount;
  }
}

}  // namespace lpv
