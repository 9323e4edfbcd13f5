#include "scene/edits.h"

#include <cmath>

namespace lpv {
namespace {

constexpr std::size_t kMaxNameBytes = 200;
constexpr double kMaxRadiance = 1e9;  // W/(sr m^2); leaves single precision room for sums
constexpr std::size_t kMaxGroupBytes = 64;

Status checkColour(const char* field, const glm::dvec3& colour, double highest) {
  for (int c = 0; c < 3; ++c) {
    if (std::isfinite(colour[c]) && colour[c] >= 0.0 && colour[c] <= highest) continue;
    return invalid(field, std::string(field) + "." + "xyz"[c] + " is " + std::to_string(colour[c]) +
                              ", allowed are 0 to " + std::to_string(highest));
  }
  return {};
}

Status checkUnit(const char* field, const std::optional<double>& value) {
  if (!value || (*value >= 0.0 && *value <= 1.0)) return {};
  return invalid(field, std::string(field) + " is " + std::to_string(*value) + ", allowed are 0 to 1");
}

}  // namespace

Status checkName(const std::string& name) {
  if (name.empty() || name.size() > kMaxNameBytes) {
    return invalid("name", "name has " + std::to_string(name.size()) + " bytes, allowed are 1 to 200");
  }
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte != 0x7F && c != '/') continue;
    return invalid("name", "name has a control character or '/': give it without");
  }
  return {};
}

Status checkFields(const LightFields& f) {
  if (f.radiance) {
    if (Status s = checkColour("radiance", *f.radiance, kMaxRadiance); !s.ok()) return s;
  }
  if (f.power) {
    if (Status s = checkColour("power", *f.power, kMaxRadiance); !s.ok()) return s;
  }
  if (f.group && f.group->size() > kMaxGroupBytes) {
    return invalid("group", "group has " + std::to_string(f.group->size()) + " bytes, allowed are 0 to 64");
  }
  if (f.group && !f.group->empty()) {
    return unimplemented("group",
                         "light group \"" + *f.group + "\": groups are not built in this version; leave it empty");
  }
  return {};
}

Status checkFields(const SurfaceFields& f) {
  if (f.albedo) {
    if (Status s = checkColour("albedo", *f.albedo, 1.0); !s.ok()) return s;
  }
  if (Status s = checkUnit("roughness", f.roughness); !s.ok()) return s;
  return checkUnit("metalness", f.metalness);
}

Expected<Transform> withFields(const Transform& transform, const TransformFields& fields) {
  Transform out = transform;
  if (fields.translation) out.translation = *fields.translation;
  if (fields.rotation) out.rotation = *fields.rotation;
  if (fields.scale) out.scale = *fields.scale;
  return checkedTransform(out);
}

}  // namespace lpv
