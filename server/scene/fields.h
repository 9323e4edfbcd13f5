#pragma once
// The fields of a light and of a surface, each declared once: its name as in
// scene.proto, how it is read and replaced, what an edit may say of it. Update
// masks, edits, undo, conversion and restoring go through these tables.
//
// A new field of plain value is a member of the object (scene.h), one of its
// ...Fields below, a line of its table below and an element of scene.proto of
// the same name.

#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>

#include "base/status.h"
#include "scene/scene.h"

namespace lpv {

/// A mesh named by hash, or carried inline (then `mesh` is set and finished).
struct MeshReference {
  BlobHash hash;
  MeshPtr mesh;
};

/// Transform fields that an edit names; unset ones stay (new objects:
/// identity).
struct TransformFields {
  std::optional<glm::dvec3> translation;
  std::optional<glm::dquat> rotation;
  std::optional<glm::dvec3> scale;
};

/// Fields of a light that an edit names. At most one of radiance and power.
struct LightFields {
  std::optional<MeshReference> mesh;
  TransformFields transform;
  std::optional<glm::dvec3> radiance;
  std::optional<glm::dvec3> power;
  std::optional<BlobHash> texture; ///< "" removes it
  std::optional<bool> twoSided;
  std::optional<bool> enabled;
  std::optional<std::string> group;
};

/// Fields of a surface that an edit names.
struct SurfaceFields {
  std::optional<MeshReference> mesh;
  TransformFields transform;
  std::optional<glm::dvec3> albedo;
  std::optional<BlobHash> albedoTexture; ///< "" removes it
  std::optional<double> roughness;
  std::optional<double> metalness;
  std::optional<bool> twoSided;
};

/// What an edit names of a T: LightFields or SurfaceFields.
template <typename T>
using FieldsOf = std::conditional_t<std::is_same_v<T, Light>, LightFields, SurfaceFields>;

/// What a light emits: radiance and power are one field, of which one or the
/// other is given.
struct Emission {
  glm::dvec3 radiance{1.0};
  std::optional<glm::dvec3> power;
};

/// The value of one field; a camera is one field, as it is only ever replaced
/// whole.
using FieldValue =
    std::variant<MeshPtr, TexturePtr, glm::dvec3, glm::dquat, Emission, bool, double, std::string, Camera>;

enum class FieldKind {
  kMesh,      ///< named by hash or brought along
  kTransform, ///< a part of the transform; checked with the others
  kTexture,   ///< named by hash
  kEmission,  ///< radiance or power
  kPlain, ///< one value, one element of the message: bool, double, string or
          ///< colour
};

/// One field of a T.
template <typename T>
struct Field {
  const char* path; ///< as in scene.proto
  FieldKind kind;
  FieldValue (*get)(const T&);
  void (*set)(T&, const FieldValue&); ///< of a value that `get` gave
  bool (*given)(const FieldsOf<T>&);   ///< whether an edit names it
  /// Range check of what an edit gives; null: every value is allowed.
  Status (*check)(const char* path, const FieldsOf<T>&) = nullptr;
  /// Replaces the object's value by a given one; null where that needs more
  /// than this field (mesh, transform, texture).
  void (*assign)(T&, const FieldsOf<T>&) = nullptr;
  /// Plain fields: gives a value of `get`'s type; else null.
  void (*give)(FieldsOf<T>&, const FieldValue&) = nullptr;
};

/// A light group: at most 64 bytes without control characters or '/'; may be
/// empty.
Status checkGroup(const char* path, const std::string& group);
/// Reflectance, each of 0..1.
Status checkAlbedo(const char* path, const glm::dvec3& albedo);
/// A number of 0..1.
Status checkUnit(const char* path, const double& value);
/// Radiance and power: each of 0..1e9.
Status checkEmission(const char* path, const LightFields& fields);

namespace fields {

template <typename T, typename V>
T ownerOf(V T::*);
template <auto kMember>
using Owner = decltype(ownerOf(kMember));
template <typename T, typename V>
V valueOf(V T::*);
template <auto kMember>
using Value = decltype(valueOf(kMember));

/// A mesh or texture, which an edit names by hash.
template <auto kMember, auto kGiven>
constexpr auto referenced(const char* path, FieldKind kind) {
  using T = Owner<kMember>;
  Field<T> out{path, kind, nullptr, nullptr, nullptr};
  out.get = [](const T& object) -> FieldValue { return object.*kMember; };
  out.set = [](T& object, const FieldValue& value) { object.*kMember = std::get<Value<kMember>>(value); };
  out.given = [](const FieldsOf<T>& in) { return (in.*kGiven).has_value(); };
  return out;
}

/// A part of the transform.
template <typename T, auto kPart, auto kGiven>
constexpr Field<T> ofTransform(const char* path) {
  Field<T> out{path, FieldKind::kTransform, nullptr, nullptr, nullptr};
  out.get = [](const T& object) -> FieldValue { return object.transform.*kPart; };
  out.set = [](T& object, const FieldValue& value) { object.transform.*kPart = std::get<Value<kPart>>(value); };
  out.given = [](const FieldsOf<T>& in) { return (in.transform.*kGiven).has_value(); };
  return out;
}

/// A value that stands in the object as in the message; `kCheck` is a
/// Status(const char* path, const Value&) or null.
template <auto kMember, auto kGiven, auto kCheck = nullptr>
constexpr auto plain(const char* path) {
  using T = Owner<kMember>;
  Field<T> out = referenced<kMember, kGiven>(path, FieldKind::kPlain);
  out.assign = [](T& object, const FieldsOf<T>& in) { object.*kMember = (in.*kGiven).value_or(object.*kMember); };
  out.give = [](FieldsOf<T>& in, const FieldValue& value) { in.*kGiven = std::get<Value<kMember>>(value); };
  if constexpr (kCheck != nullptr) {
    out.check = [](const char* name, const FieldsOf<T>& in) {
      return in.*kGiven ? kCheck(name, *(in.*kGiven)) : Status();
    };
  }
  return out;
}

/// A flag whose opposite is in the message.
template <auto kMember, auto kGiven>
constexpr auto inverted(const char* path) {
  using T = Owner<kMember>;
  Field<T> out = plain<kMember, kGiven>(path);
  out.get = [](const T& object) -> FieldValue { return !(object.*kMember); };
  out.set = [](T& object, const FieldValue& value) { object.*kMember = !std::get<bool>(value); };
  out.give = [](FieldsOf<T>& in, const FieldValue& value) { in.*kGiven = !std::get<bool>(value); };
  return out;
}

/// Radiance, or power in its place.
constexpr Field<Light> emission(const char* path) {
  Field<Light> out{path, FieldKind::kEmission, nullptr, nullptr, nullptr, checkEmission};
  out.get = [](const Light& light) -> FieldValue { return Emission{light.radiance, light.power}; };
  out.set = [](Light& light, const FieldValue& value) {
    light.radiance = std::get<Emission>(value).radiance;
    light.power = std::get<Emission>(value).power;
  };
  out.given = [](const LightFields& in) { return in.radiance.has_value() || in.power.has_value(); };
  out.assign = [](Light& light, const LightFields& in) {
    if (in.radiance) {
      light.radiance = *in.radiance;
      light.power.reset();
    }
    if (in.power) light.power = in.power;
  };
  return out;
}

inline constexpr std::array kLight = {
    referenced<&Light::mesh, &LightFields::mesh>("mesh", FieldKind::kMesh),
    ofTransform<Light, &Transform::translation, &TransformFields::translation>("transform.translation"),
    ofTransform<Light, &Transform::rotation, &TransformFields::rotation>("transform.rotation"),
    ofTransform<Light, &Transform::scale, &TransformFields::scale>("transform.scale"),
    referenced<&Light::texture, &LightFields::texture>("texture", FieldKind::kTexture),
    emission("radiance"),
    plain<&Light::twoSided, &LightFields::twoSided>("two_sided"),
    plain<&Light::enabled, &LightFields::enabled>("enabled"),
    plain<&Light::group, &LightFields::group, checkGroup>("group"),
};

inline constexpr std::array kSurface = {
    referenced<&Surface::mesh, &SurfaceFields::mesh>("mesh", FieldKind::kMesh),
    ofTransform<Surface, &Transform::translation, &TransformFields::translation>("transform.translation"),
    ofTransform<Surface, &Transform::rotation, &TransformFields::rotation>("transform.rotation"),
    ofTransform<Surface, &Transform::scale, &TransformFields::scale>("transform.scale"),
    referenced<&Surface::albedoTexture, &SurfaceFields::albedoTexture>("albedo_texture", FieldKind::kTexture),
    plain<&Surface::albedo, &SurfaceFields::albedo, checkAlbedo>("albedo"),
    plain<&Surface::roughness, &SurfaceFields::roughness, checkUnit>("roughness"),
    plain<&Surface::metalness, &SurfaceFields::metalness, checkUnit>("metalness"),
    inverted<&Surface::twoSided, &SurfaceFields::twoSided>("one_sided"),
};

} // namespace fields

/// The table of a T; a field's number is its place in it.
template <typename T>
constexpr const auto& fieldTable() {
  if constexpr (std::is_same_v<T, Light>) {
    return fields::kLight;
  } else {
    return fields::kSurface;
  }
}

/// The field that new vertices replace, of either kind.
inline constexpr std::size_t kMeshField = 0;
static_assert(fields::kLight[kMeshField].kind == FieldKind::kMesh);
static_assert(fields::kSurface[kMeshField].kind == FieldKind::kMesh);

inline constexpr std::size_t kMaxFields = std::max(fields::kLight.size(), fields::kSurface.size());
using FieldSet = std::bitset<kMaxFields>;

/// Fields that an edit names.
template <typename Fields>
FieldSet fieldsIn(const Fields& in) {
  using T = std::conditional_t<std::is_same_v<Fields, LightFields>, Light, Surface>;
  FieldSet out;
  for (std::size_t i = 0; i < fieldTable<T>().size(); ++i) out[i] = fieldTable<T>()[i].given(in);
  return out;
}

/// Range checks of values an edit brings; references are the document's
/// business. The error names the first field, in the order of the table.
Status checkFields(const LightFields& fields);
Status checkFields(const SurfaceFields& fields);

/// Replaces what is given of the object, but for mesh, transform and texture;
/// the values are checked.
template <typename T>
void assignValues(T& object, const FieldsOf<T>& in) {
  for (const Field<T>& field : fieldTable<T>()) {
    if (field.assign) field.assign(object, in);
  }
}

/// The transform with the named fields replaced, checked.
Expected<Transform> withFields(const Transform& transform, const TransformFields& fields);

} // namespace lpv
