#pragma once
// Edits as values of the domain. convert/ makes them from messages; a session's document applies them.

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/status.h"
#include "scene/fields.h"

namespace lpv {

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

}  // namespace lpv
