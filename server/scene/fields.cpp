#include "scene/fields.h"

#include <cmath>

#include "base/text.h"
#include "scene/words.h"

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

template <typename T>
Status checkTable(const FieldsOf<T>& in) {
  for (const Field<T>& field : fieldTable<T>()) {
    if (!field.check) continue;
    if (Status s = field.check(field.path, in); !s.ok()) return s;
  }
  return {};
}

}  // namespace

Status checkVisible(const char* field, const std::string& text) {
  const std::optional<HiddenCharacter> hidden = findHiddenCharacter(text);
  if (!hidden) return {};
  return invalid(field, std::string(field) + " has the character " + hidden->name() + " at byte " +
                            std::to_string(hidden->at) +
                            ": leave out control characters and those that are invisible or change the direction");
}

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
  return checkVisible(field, words);
}

Status checkGroup(const char* path, const std::string& group) { return checkWords(path, group, 0, kMaxGroupBytes); }

Status checkAlbedo(const char* path, const glm::dvec3& albedo) { return checkColour(path, albedo, 1.0); }

Status checkAlphaMode(const char* path, const AlphaMode& mode) {
  switch (mode) {
    case AlphaMode::kOpaque:
    case AlphaMode::kMask:
    case AlphaMode::kBlend:
      return {};
  }
  return invalid(path, std::string(path) + " is " + std::to_string(int(mode)) +
                           ", allowed are OPAQUE (1), MASK (2) and BLEND (3)");
}

Status checkNormalScale(const char* path, const double& value) {
  if (value >= 0.0 && value <= 16.0) return {};
  return invalid(path, std::string(path) + " is " + std::to_string(value) + ", allowed are 0 to 16");
}

Status checkUnit(const char* path, const double& value) {
  if (value >= 0.0 && value <= 1.0) return {};
  return invalid(path, std::string(path) + " is " + std::to_string(value) + ", allowed are 0 to 1");
}

Status checkEmission(const char*, const LightFields& fields) {
  if (fields.radiance) {
    if (Status s = checkColour("radiance", *fields.radiance, kMaxRadiance); !s.ok()) return s;
  }
  return fields.power ? checkColour("power", *fields.power, kMaxRadiance) : Status();
}

Status checkFields(const LightFields& fields) { return checkTable<Light>(fields); }

Status checkFields(const SurfaceFields& fields) { return checkTable<Surface>(fields); }

Expected<Transform> withFields(const Transform& transform, const TransformFields& fields) {
  Transform out = transform;
  if (fields.translation) out.translation = *fields.translation;
  if (fields.rotation) out.rotation = *fields.rotation;
  if (fields.scale) out.scale = *fields.scale;
  return checkedTransform(out);
}

}  // namespace lpv
