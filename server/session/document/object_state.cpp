#include "session/document/object_state.h"

#include <memory>

namespace lpv {
namespace {

template <typename T>
std::shared_ptr<const T> replaced(const T& object, std::size_t field, const FieldValue& value) {
  auto out = std::make_shared<T>(object);
  fieldTable<T>()[field].set(*out, value);
  return out;
}

/// The field's path; of the emission, that of radiance or power, whichever the light has.
const char* pathOf(const Light& light, std::size_t field) {
  const Field<Light>& found = fieldTable<Light>()[field];
  return found.kind == FieldKind::kEmission && light.power ? "power" : found.path;
}

}  // namespace

std::size_t fieldCount(const ObjectState& object) {
  if (object.light) return fieldTable<Light>().size();
  if (object.surface) return fieldTable<Surface>().size();
  return object.camera ? 1 : 0;
}

std::string fieldName(const ObjectKey& key, const ObjectState& object, std::size_t field) {
  if (object.light) return key.name + "." + pathOf(*object.light, field);
  return object.surface ? key.name + "." + fieldTable<Surface>()[field].path : key.name;
}

FieldValue fieldOf(const ObjectState& object, std::size_t field) {
  if (object.light) return fieldTable<Light>()[field].get(*object.light);
  if (object.surface) return fieldTable<Surface>()[field].get(*object.surface);
  return *object.camera;
}

ObjectState withField(const ObjectState& object, std::size_t field, const FieldValue& value) {
  if (object.light) return {replaced(*object.light, field, value), nullptr, std::nullopt};
  if (object.surface) return {nullptr, replaced(*object.surface, field, value), std::nullopt};
  return {nullptr, nullptr, std::get<Camera>(value)};
}

Bounds boundsOf(const ObjectState& object) {
  const auto placed = [](const auto& each) { return each.mesh->bounds.transformed(each.transform.worldFromObject()); };
  if (object.light) return object.light->enabled ? placed(*object.light) : Bounds();
  return object.surface ? placed(*object.surface) : Bounds();
}

}  // namespace lpv
