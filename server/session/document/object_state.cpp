#include "session/document/object_state.h"

#include <array>
#include <memory>

namespace lpv {
namespace {

/// Fields that lights and surfaces have in common come first; then each kind's own.
enum Field : std::size_t {
  kTranslation = kMeshField + 1,
  kRotation,
  kScale,
  kTexture,
  kTwoSided,
  kFirstOwn,
  kEmission = kFirstOwn,
  kEnabled,
  kGroup,
  kAlbedo = kFirstOwn,
  kRoughness,
  kMetalness,
};
static_assert(kGroup + 1 == kMaxFields && kMetalness + 1 == kMaxFields);

constexpr std::array<const char*, kMaxFields> kLightPaths = {"mesh",
                                                             "transform.translation",
                                                             "transform.rotation",
                                                             "transform.scale",
                                                             "texture",
                                                             "two_sided",
                                                             "radiance",
                                                             "enabled",
                                                             "group"};
constexpr std::array<const char*, kMaxFields> kSurfacePaths = {"mesh",
                                                               "transform.translation",
                                                               "transform.rotation",
                                                               "transform.scale",
                                                               "albedo_texture",
                                                               "two_sided",
                                                               "albedo",
                                                               "roughness",
                                                               "metalness"};

FieldValue valueOf(const Light& light, std::size_t field) {
  switch (field) {
    case kMeshField:
      return light.mesh;
    case kTranslation:
      return light.transform.translation;
    case kRotation:
      return light.transform.rotation;
    case kScale:
      return light.transform.scale;
    case kTexture:
      return light.texture;
    case kTwoSided:
      return light.twoSided;
    case kEmission:
      return Emission{light.radiance, light.power};
    case kEnabled:
      return light.enabled;
    default:
      return light.group;
  }
}

FieldValue valueOf(const Surface& surface, std::size_t field) {
  switch (field) {
    case kMeshField:
      return surface.mesh;
    case kTranslation:
      return surface.transform.translation;
    case kRotation:
      return surface.transform.rotation;
    case kScale:
      return surface.transform.scale;
    case kTexture:
      return surface.albedoTexture;
    case kTwoSided:
      return surface.twoSided;
    case kAlbedo:
      return surface.albedo;
    case kRoughness:
      return surface.roughness;
    default:
      return surface.metalness;
  }
}

void assign(Light& light, std::size_t field, const FieldValue& value) {
  switch (field) {
    case kMeshField:
      light.mesh = std::get<MeshPtr>(value);
      break;
    case kTranslation:
      light.transform.translation = std::get<glm::dvec3>(value);
      break;
    case kRotation:
      light.transform.rotation = std::get<glm::dquat>(value);
      break;
    case kScale:
      light.transform.scale = std::get<glm::dvec3>(value);
      break;
    case kTexture:
      light.texture = std::get<TexturePtr>(value);
      break;
    case kTwoSided:
      light.twoSided = std::get<bool>(value);
      break;
    case kEmission:
      light.radiance = std::get<Emission>(value).radiance;
      light.power = std::get<Emission>(value).power;
      break;
    case kEnabled:
      light.enabled = std::get<bool>(value);
      break;
    default:
      light.group = std::get<std::string>(value);
  }
}

void assign(Surface& surface, std::size_t field, const FieldValue& value) {
  switch (field) {
    case kMeshField:
      surface.mesh = std::get<MeshPtr>(value);
      break;
    case kTranslation:
      surface.transform.translation = std::get<glm::dvec3>(value);
      break;
    case kRotation:
      surface.transform.rotation = std::get<glm::dquat>(value);
      break;
    case kScale:
      surface.transform.scale = std::get<glm::dvec3>(value);
      break;
    case kTexture:
      surface.albedoTexture = std::get<TexturePtr>(value);
      break;
    case kTwoSided:
      surface.twoSided = std::get<bool>(value);
      break;
    case kAlbedo:
      surface.albedo = std::get<glm::dvec3>(value);
      break;
    case kRoughness:
      surface.roughness = std::get<double>(value);
      break;
    default:
      surface.metalness = std::get<double>(value);
  }
}

template <typename T>
std::shared_ptr<const T> replaced(const T& object, std::size_t field, const FieldValue& value) {
  auto out = std::make_shared<T>(object);
  assign(*out, field, value);
  return out;
}

void addTransform(const TransformFields& transform, FieldSet& out) {
  out[kTranslation] = transform.translation.has_value();
  out[kRotation] = transform.rotation.has_value();
  out[kScale] = transform.scale.has_value();
}

}  // namespace

std::size_t fieldCount(const ObjectState& object) {
  if (object.light || object.surface) return kMaxFields;
  return object.camera ? 1 : 0;
}

std::string fieldName(const ObjectKey& key, const ObjectState& object, std::size_t field) {
  if (object.light) {
    return key.name + "." + (field == kEmission && object.light->power ? "power" : kLightPaths[field]);
  }
  return object.surface ? key.name + "." + kSurfacePaths[field] : key.name;
}

FieldValue fieldOf(const ObjectState& object, std::size_t field) {
  if (object.light) return valueOf(*object.light, field);
  if (object.surface) return valueOf(*object.surface, field);
  return *object.camera;
}

ObjectState withField(const ObjectState& object, std::size_t field, const FieldValue& value) {
  if (object.light) return {replaced(*object.light, field, value), nullptr, std::nullopt};
  if (object.surface) return {nullptr, replaced(*object.surface, field, value), std::nullopt};
  return {nullptr, nullptr, std::get<Camera>(value)};
}

FieldSet fieldsIn(const LightFields& fields) {
  FieldSet out;
  addTransform(fields.transform, out);
  out[kMeshField] = fields.mesh.has_value();
  out[kTexture] = fields.texture.has_value();
  out[kTwoSided] = fields.twoSided.has_value();
  out[kEmission] = fields.radiance.has_value() || fields.power.has_value();
  out[kEnabled] = fields.enabled.has_value();
  out[kGroup] = fields.group.has_value();
  return out;
}

FieldSet fieldsIn(const SurfaceFields& fields) {
  FieldSet out;
  addTransform(fields.transform, out);
  out[kMeshField] = fields.mesh.has_value();
  out[kTexture] = fields.albedoTexture.has_value();
  out[kTwoSided] = fields.twoSided.has_value();
  out[kAlbedo] = fields.albedo.has_value();
  out[kRoughness] = fields.roughness.has_value();
  out[kMetalness] = fields.metalness.has_value();
  return out;
}

}  // namespace lpv
