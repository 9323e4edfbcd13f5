#pragma once
// The fields of a light and of a surface, each declared once: its path as in scene.proto, how it is read, replaced and
// checked. Update masks, edits, undo, conversion and restoring go through these tables.
//
// A new field of plain value is a member of the object (scene.h), a member of LightFields or SurfaceFields, a row of
// the table below and a field of the same name in scene.proto.

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

/// Transform fields that an edit changes; unset ones keep their values (new objects: identity).
struct TransformFields {
  std::optional<glm::dvec3> translation;
  std::optional<glm::dquat> rotation;
  std::optional<glm::dvec3> scale;
};

/// Fields of a light that an edit changes. At most one of radiance and power.
struct LightFields {
  std::optional<MeshReference> mesh;
  TransformFields transform;
  std::optional<glm::dvec3> radiance;
  std::optional<glm::dvec3> power;
  std::optional<BlobHash> texture;  ///< "" removes it
  std::optional<bool> twoSided;
  std::optional<bool> enabled;
  std::optional<std::string> group;
  std::optional<bool> castsShadow;
  std::optional<bool> visibleToCamera;
  std::optional<bool> distant;
};

/// Fields of a surface that an edit changes.
struct SurfaceFields {
  std::optional<MeshReference> mesh;
  TransformFields transform;
  std::optional<glm::dvec3> albedo;
  std::optional<BlobHash> albedoTexture;  ///< "" removes it
  std::optional<BlobHash> normalTexture;  ///< "" removes it
  std::optional<double> normalScale;
  std::optional<double> roughness;
  std::optional<double> metalness;
  std::optional<BlobHash> glossTexture;  ///< "" removes it
  std::optional<bool> twoSided;
  std::optional<bool> castsShadow;
  std::optional<bool> visibleToCamera;
  std::optional<AlphaMode> alphaMode;
  std::optional<double> alphaCutoff;
  std::optional<double> opacity;
  std::optional<glm::dvec3> transmission;
};

/// LightFields of a Light, SurfaceFields of a Surface.
template <typename T>
using FieldsOf = std::conditional_t<std::is_same_v<T, Light>, LightFields, SurfaceFields>;

/// What a light emits: radiance and power are one field, as in scene.proto.
struct Emission {
  glm::dvec3 radiance{1.0};
  std::optional<glm::dvec3> power;
};

/// The value of one field. A camera is one field, as it is only ever replaced whole.
using FieldValue =
    std::variant<MeshPtr, TexturePtr, glm::dvec3, glm::dquat, Emission, bool, double, std::string, AlphaMode, Camera>;

enum class FieldKind {
  kMesh,       ///< named by hash or inline
  kTransform,  ///< translation, rotation or scale; the transform is checked as a whole
  kTexture,    ///< named by hash
  kEmission,   ///< radiance or power
  kPlain,      ///< one value in one field of the message: bool, double, string, alpha mode or colour
};

/// One field of a T.
template <typename T>
struct Field {
  const char* path;  ///< as in scene.proto
  FieldKind kind;
  FieldValue (*get)(const T&);
  void (*set)(T&, const FieldValue&);  ///< takes a value that `get` returned
  bool (*given)(const FieldsOf<T>&);   ///< whether an edit changes it
  /// Checks the range of the new value; null: every value is allowed.
  Status (*check)(const char* path, const FieldsOf<T>&) = nullptr;
  /// Replaces the object's value where an edit changes it; null where that needs more than this field (mesh, transform,
  /// texture).
  void (*assign)(T&, const FieldsOf<T>&) = nullptr;
  /// Has an edit change the field to a value of `get`'s type; null but for plain fields.
  void (*give)(FieldsOf<T>&, const FieldValue&) = nullptr;
};

/// A light group: as a name, but 0..64 bytes.
Status checkGroup(const char* path, const std::string& group);
/// Reflectance, and what is let through: each component 0..1.
Status checkAlbedo(const char* path, const glm::dvec3& albedo);
/// One of the modes that there are.
Status checkAlphaMode(const char* path, const AlphaMode& mode);
/// A number in 0..1.
Status checkUnit(const char* path, const double& value);
/// How much a picture of normals bends: 0..16.
Status checkNormalScale(const char* path, const double& value);
/// Radiance and power: each component 0..1e9.
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

/// A mesh or texture: edits name it by hash, the document looks it up.
template <auto kMember, auto kGiven>
constexpr auto referenced(const char* path, FieldKind kind) {
  using T = Owner<kMember>;
  Field<T> out{path, kind, nullptr, nullptr, nullptr};
  out.get = [](const T& object) -> FieldValue { return object.*kMember; };
  out.set = [](T& object, const FieldValue& value) { object.*kMember = std::get<Value<kMember>>(value); };
  out.given = [](const FieldsOf<T>& in) { return (in.*kGiven).has_value(); };
  return out;
}

/// Translation, rotation or scale.
template <typename T, auto kPart, auto kGiven>
constexpr Field<T> ofTransform(const char* path) {
  Field<T> out{path, FieldKind::kTransform, nullptr, nullptr, nullptr};
  out.get = [](const T& object) -> FieldValue { return object.transform.*kPart; };
  out.set = [](T& object, const FieldValue& value) { object.transform.*kPart = std::get<Value<kPart>>(value); };
  out.given = [](const FieldsOf<T>& in) { return (in.transform.*kGiven).has_value(); };
  return out;
}

/// A value that is the same in the object and in the message. kCheck: Status(const char* path, const Value&), or null.
template <auto kMember, auto kGiven, auto kCheck = nullptr>
constexpr auto plain(const char* path) {
  using T = Owner<kMember>;
  Field<T> out = referenced<kMember, kGiven>(path, FieldKind::kPlain);
  out.assign = [](T& object, const FieldsOf<T>& in) {
    if (in.*kGiven) object.*kMember = *(in.*kGiven);
  };
  out.give = [](FieldsOf<T>& in, const FieldValue& value) { in.*kGiven = std::get<Value<kMember>>(value); };
  if constexpr (!std::is_null_pointer_v<decltype(kCheck)>) {
    out.check = [](const char* name, const FieldsOf<T>& in) {
      return in.*kGiven ? kCheck(name, *(in.*kGiven)) : Status();
    };
  }
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
    plain<&Light::twoSided, &LightFields::twoSided>("two_sided"),
    emission("radiance"),
    plain<&Light::enabled, &LightFields::enabled>("enabled"),
    plain<&Light::group, &LightFields::group, checkGroup>("group"),
    plain<&Light::castsShadow, &LightFields::castsShadow>("casts_shadow"),
    plain<&Light::visibleToCamera, &LightFields::visibleToCamera>("visible_to_camera"),
    plain<&Light::distant, &LightFields::distant>("distant"),
};

inline constexpr std::array kSurface = {
    referenced<&Surface::mesh, &SurfaceFields::mesh>("mesh", FieldKind::kMesh),
    ofTransform<Surface, &Transform::translation, &TransformFields::translation>("transform.translation"),
    ofTransform<Surface, &Transform::rotation, &TransformFields::rotation>("transform.rotation"),
    ofTransform<Surface, &Transform::scale, &TransformFields::scale>("transform.scale"),
    referenced<&Surface::albedoTexture, &SurfaceFields::albedoTexture>("albedo_texture", FieldKind::kTexture),
    referenced<&Surface::normalTexture, &SurfaceFields::normalTexture>("normal_texture", FieldKind::kTexture),
    referenced<&Surface::glossTexture, &SurfaceFields::glossTexture>("gloss_texture", FieldKind::kTexture),
    plain<&Surface::normalScale, &SurfaceFields::normalScale, checkNormalScale>("normal_scale"),
    plain<&Surface::twoSided, &SurfaceFields::twoSided>("two_sided"),
    plain<&Surface::albedo, &SurfaceFields::albedo, checkAlbedo>("albedo"),
    plain<&Surface::roughness, &SurfaceFields::roughness, checkUnit>("roughness"),
    plain<&Surface::metalness, &SurfaceFields::metalness, checkUnit>("metalness"),
    plain<&Surface::castsShadow, &SurfaceFields::castsShadow>("casts_shadow"),
    plain<&Surface::visibleToCamera, &SurfaceFields::visibleToCamera>("visible_to_camera"),
    plain<&Surface::alphaMode, &SurfaceFields::alphaMode, checkAlphaMode>("alpha_mode"),
    plain<&Surface::alphaCutoff, &SurfaceFields::alphaCutoff, checkUnit>("alpha_cutoff"),
    plain<&Surface::opacity, &SurfaceFields::opacity, checkUnit>("opacity"),
    plain<&Surface::transmission, &SurfaceFields::transmission, checkAlbedo>("transmission"),
};

}  // namespace fields

/// The table of a T; a field's number is its index.
template <typename T>
constexpr const auto& fieldTable() {
  if constexpr (std::is_same_v<T, Light>) {
    return fields::kLight;
  } else {
    return fields::kSurface;
  }
}

/// The field that new vertices replace, in both tables.
inline constexpr std::size_t kMeshField = 0;
static_assert(fields::kLight[kMeshField].kind == FieldKind::kMesh);
static_assert(fields::kSurface[kMeshField].kind == FieldKind::kMesh);

inline constexpr std::size_t kMaxFields = std::max(fields::kLight.size(), fields::kSurface.size());
using FieldSet = std::bitset<kMaxFields>;

/// Fields that an edit changes.
template <typename Fields>
FieldSet fieldsIn(const Fields& in) {
  using T = std::conditional_t<std::is_same_v<Fields, LightFields>, Light, Surface>;
  FieldSet out;
  for (std::size_t i = 0; i < fieldTable<T>().size(); ++i) out[i] = fieldTable<T>()[i].given(in);
  return out;
}

/// Checks the ranges of an edit's values, in the order of the table; the document checks references.
Status checkFields(const LightFields& fields);
Status checkFields(const SurfaceFields& fields);

/// Replaces the object's values that an edit changes, except mesh, transform and texture. The values have been checked.
template <typename T>
void assignValues(T& object, const FieldsOf<T>& in) {
  for (const Field<T>& field : fieldTable<T>()) {
    if (field.assign) field.assign(object, in);
  }
}

/// The transform with the named fields replaced, checked.
Expected<Transform> withFields(const Transform& transform, const TransformFields& fields);

}  // namespace lpv
