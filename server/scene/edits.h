#pragma once
// Edits as values of the domain. convert/ makes them from messages; a session's document applies them.

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

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
};

/// Fields of a surface that an edit changes.
struct SurfaceFields {
  std::optional<MeshReference> mesh;
  TransformFields transform;
  std::optional<glm::dvec3> albedo;
  std::optional<BlobHash> albedoTexture;  ///< "" removes it
  std::optional<double> roughness;
  std::optional<double> metalness;
  std::optional<bool> twoSided;
};

struct CreateLight {
  std::string name;
  LightFields fields;
};
struct UpdateLight {
  std::string name;
  LightFields fields;
};
struct DeleteLight {
  std::string name;
};
struct CreateSurface {
  std::string name;
  SurfaceFields fields;
};
struct UpdateSurface {
  std::string name;
  SurfaceFields fields;
};
struct DeleteSurface {
  std::string name;
};

/// New vertices for a light's or surface's mesh, triangles unchanged. `base` and `deformed` are filled beforehand,
/// outside any lock, by prepareVertices; the document uses them where `base` is still the object's mesh.
struct SetVertices {
  std::string object;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;  ///< empty: recomputed where the mesh has normals
  MeshPtr base;
  MeshPtr deformed;
};

struct PutCamera {
  std::string name;
  Camera camera;
};
struct DeleteCamera {
  std::string name;
};
struct FitGrid {};

using Operation = std::variant<CreateLight, UpdateLight, DeleteLight, CreateSurface, UpdateSurface, DeleteSurface,
                               SetVertices, PutCamera, DeleteCamera, FitGrid>;

/// Operations that are applied all or not at all, with one revision and one undo step.
struct Edit {
  std::uint64_t sequence = 0;
  std::vector<Operation> operations;
  std::optional<std::uint64_t> expectedRevision;
  std::string undoGroup;
};

/// 1..200 bytes, no control characters, no '/'.
inline constexpr std::size_t kMaxNameBytes = 200;
Status checkName(const std::string& name);
/// A light group: as a name, but 0..64 bytes.
Status checkGroup(const std::string& group);

/// Checks the ranges of an edit's values; the document checks references.
Status checkFields(const LightFields& fields);
Status checkFields(const SurfaceFields& fields);

/// The transform with the named fields replaced, checked.
Expected<Transform> withFields(const Transform& transform, const TransformFields& fields);

}  // namespace lpv
