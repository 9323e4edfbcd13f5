#include "scene/edits.h"

#include <cmath>

namespace lpv {
namespace {

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

/// Checks the name of an object or a group.
Status checkWords(const char* field, const std::string& words, std::size_t least, std::size_t most) {
  if (words.size() < least || words.size() > most) {
    return invalid(field, std::string(field) + " has " + std::to_string(words.size()) + " bytes, allowed are " +
                              std::to_string(least) + " to " + std::to_string(most));
  }
  for (const char c : words) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte != 0x7F && c != '/') continue;
    return invalid(field, std::string(field) + " has a control character or '/': give it without");
  }
  return {};
}

Status checkUnit(const char* field, const std::optional<double>& value) {
  if (!value || (*value >= 0.0 && *value <= 1.0)) return {};
  return invalid(field, std::string(field) + " is " + std::to_string(*value) + ", allowed are 0 to 1");
}

}  // namespace

Status checkName(const std::string& name) { return checkWords("name", name, 1, kMaxNameBytes); }

Status checkGroup(const std::string& group) { return checkWords("group", group, 0, kMaxGroupBytes); }

Status checkFields(const LightFields& f) {
  if (f.radiance) {
    if (Status s = checkColour("radiance", *f.radiance, kMaxRadiance); !s.ok()) return s;
  }
  if (f.power) {
    if (Status s = checkColour("power", *f.power, kMaxRadiance); !s.ok()) return s;
  }
  return f.group ? checkGroup(*f.group) : Status();
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
