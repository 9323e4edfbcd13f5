#pragma once
// One object of a scene as a value: what a name stands for, field by field.

#include <compare>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "scene/bounds.h"
#include "scene/fields.h"
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

/// How many fields there are in what stands there: those of a light or surface are numbered as in scene/fields.h, a
/// camera is one field.
std::size_t fieldCount(const ObjectState& object);
/// "name.path", the path as in scene.proto; of a camera, and for an object as a whole, the name.
std::string fieldName(const ObjectKey& key, const ObjectState& object, std::size_t field);
FieldValue fieldOf(const ObjectState& object, std::size_t field);
/// `object` with that field replaced; the value is one that fieldOf gave for an object of the same kind.
ObjectState withField(const ObjectState& object, std::size_t field, const FieldValue& value);
/// World bounds, metres, of what a fitted grid holds; empty for a camera and for a light that is off.
Bounds boundsOf(const ObjectState& object);

}  // namespace lpv
