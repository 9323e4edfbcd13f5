#pragma once
// Makes the operations of an edit, one function for each kind:
//
//   v1::Edit edit = editOf({moveLight("Tv", {.translation = glm::dvec3(0, 1, 0)}), fitGrid()});

#include <optional>
#include <string>
#include <vector>

#include "lpv/v1/scene.pb.h"
#include "scene/camera.h"
#include "scene/mesh.h"
#include "scene/transform.h"

namespace lpv::client {

/// Parts of a transform to change; unset parts keep their values.
struct Move {
  std::optional<glm::dvec3> translation = {};  ///< world, metres
  std::optional<glm::dquat> rotation = {};     ///< unit; see rotationFromEulerDegrees
  std::optional<glm::dvec3> scale = {};        ///< factors along the object's axes
};

/// One edit of several operations: applied all or not at all, one revision, one undo step.
v1::Edit editOf(std::vector<v1::Operation> operations);

v1::Operation createLight(v1::Light light);
v1::Operation createSurface(v1::Surface surface);
v1::Operation putCamera(const std::string& name, const Camera& camera);
/// `paths`: fields of Light or Surface to change, e.g. "radiance"; see UpdateLight and UpdateSurface in scene.proto.
v1::Operation updateLight(v1::Light light, const std::vector<std::string>& paths);
v1::Operation updateSurface(v1::Surface surface, const std::vector<std::string>& paths);
v1::Operation moveLight(const std::string& name, const Move& move);
v1::Operation moveSurface(const std::string& name, const Move& move);
/// W/(sr m^2), linear Rec.709.
v1::Operation setRadiance(const std::string& light, const glm::dvec3& radiance);
v1::Operation setEnabled(const std::string& light, bool enabled);
/// `mesh`: hash of a mesh that has been uploaded.
v1::Operation setLightMesh(const std::string& light, const BlobHash& mesh);
/// Replaces the vertices of an object's mesh, with the same triangles; for meshes that deform.
v1::Operation setVertices(const std::string& object, const std::vector<glm::vec3>& positions,
                          const std::vector<glm::vec3>& normals = {});
v1::Operation deleteLight(const std::string& name);
v1::Operation deleteSurface(const std::string& name);
v1::Operation deleteCamera(const std::string& name);
/// Fits the grid to the content, as scene loading does at its end.
v1::Operation fitGrid();

}  // namespace lpv::client
