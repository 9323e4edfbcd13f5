#pragma once
// One object of a scene as a value: what a name stands for, field by field.

#include <bitset>
#include <compare>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "scene/edits.h"
#include "scene/scene.h"

namespace lpv {

/// A name. Lights and surfaces share one name space, cameras have their own.
struct ObjectKey {
  bool camera = false;
  std::string name;
  auto operator<=>(const ObjectKey&) const = default;
};

/// What stands under a name: one of these, or nothing.
struct ObjectState {
  LightPtr light;
  SurfacePtr surface;
  std::optional<Camera> camera;

  bool stands() const { return light || surface || camera; }
};

/// An object as it shall be.
using NamedState = std::pair<ObjectKey, ObjectState>;

/// What a light emits: radiance and power are one field, as in scene.proto.
struct Emission {
  glm::dvec3 radiance{1.0};
  std::optional<glm::dvec3> power;
};

/// The value of one field.
using FieldValue =
    std::variant<MeshPtr, TexturePtr, glm::dvec3, glm::dquat, Emission, bool, double, std::string, Camera>;

/// Fields of an object are numbered; a camera is one field, as it is only ever replaced whole.
inline constexpr std::size_t kMaxFields = 9;
using FieldSet = std::bitset<kMaxFields>;

/// How many fields there are in what stands there.
std::size_t fieldCount(const ObjectState& object);
/// "name.path", the path as in scene.proto; of a camera, and for an object as a whole, the name.
std::string fieldName(const ObjectKey& key, const ObjectState& object, std::size_t field);
FieldValue fieldOf(const ObjectState& object, std::size_t field);
/// `object` with that field replaced; the value is one that fieldOf gave for an object of the same kind.
ObjectState withField(const ObjectState& object, std::size_t field, const FieldValue& value);

/// Fields that an edit names.
FieldSet fieldsIn(const LightFields& fields);
FieldSet fieldsIn(const SurfaceFields& fields);
/// The one that new vertices replace.
inline constexpr std::size_t kMeshField = 0;

}  // namespace lpv
