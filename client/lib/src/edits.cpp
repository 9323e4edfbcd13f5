#include "lpv/edits.h"

#include <utility>

#include "lpv/convert.h"

namespace lpv::client {
namespace {

/// Writes the given parts of a transform and adds their paths to the mask.
template <typename Update>
void writeMove(const Move& move, v1::Transform& transform, Update& update) {
  if (move.translation) {
    *transform.mutable_translation() = toProto(*move.translation);
    update.mutable_update_mask()->add_paths("transform.translation");
  }
  if (move.rotation) {
    *transform.mutable_rotation() = toProto(*move.rotation);
    update.mutable_update_mask()->add_paths("transform.rotation");
  }
  if (move.scale) {
    *transform.mutable_scale() = toProto(*move.scale);
    update.mutable_update_mask()->add_paths("transform.scale");
  }
}

v1::Light named(const std::string& name) {
  v1::Light light;
  light.set_name(name);
  return light;
}

std::string bytesOf(const std::vector<glm::vec3>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(glm::vec3));
}

}  // namespace

v1::Edit editOf(std::vector<v1::Operation> operations) {
  v1::Edit edit;
  for (v1::Operation& operation : operations) *edit.add_operations() = std::move(operation);
  return edit;
}

v1::Operation createLight(v1::Light light) {
  v1::Operation operation;
  *operation.mutable_create_light() = std::move(light);
  return operation;
}

v1::Operation createSurface(v1::Surface surface) {
  v1::Operation operation;
  *operation.mutable_create_surface() = std::move(surface);
  return operation;
}

v1::Operation putCamera(const std::string& name, const Camera& camera) {
  v1::Operation operation;
  *operation.mutable_put_camera() = toProto(camera, name);
  return operation;
}

v1::Operation updateLight(v1::Light light, const std::vector<std::string>& paths) {
  v1::Operation operation;
  *operation.mutable_update_light()->mutable_light() = std::move(light);
  for (const std::string& path : paths) operation.mutable_update_light()->mutable_update_mask()->add_paths(path);
  return operation;
}

v1::Operation updateSurface(v1::Surface surface, const std::vector<std::string>& paths) {
  v1::Operation operation;
  *operation.mutable_update_surface()->mutable_surface() = std::move(surface);
  for (const std::string& path : paths) operation.mutable_update_surface()->mutable_update_mask()->add_paths(path);
  return operation;
}

v1::Operation moveLight(const std::string& name, const Move& move) {
  v1::Operation operation;
  v1::UpdateLight& update = *operation.mutable_update_light();
  update.mutable_light()->set_name(name);
  writeMove(move, *update.mutable_light()->mutable_transform(), update);
  return operation;
}

v1::Operation moveSurface(const std::string& name, const Move& move) {
  v1::Operation operation;
  v1::UpdateSurface& update = *operation.mutable_update_surface();
  update.mutable_surface()->set_name(name);
  writeMove(move, *update.mutable_surface()->mutable_transform(), update);
  return operation;
}

v1::Operation setRadiance(const std::string& light, const glm::dvec3& radiance) {
  v1::Light change = named(light);
  *change.mutable_radiance() = toProto(radiance);
  return updateLight(std::move(change), {"radiance"});
}

v1::Operation setEnabled(const std::string& light, bool enabled) {
  v1::Light change = named(light);
  change.set_enabled(enabled);
  return updateLight(std::move(change), {"enabled"});
}

v1::Operation setLightMesh(const std::string& light, const BlobHash& mesh) {
  v1::Light change = named(light);
  change.set_mesh(mesh);
  return updateLight(std::move(change), {"mesh"});
}

v1::Operation setVertices(const std::string& object, const std::vector<glm::vec3>& positions,
                          const std::vector<glm::vec3>& normals) {
  v1::Operation operation;
  operation.mutable_set_vertices()->set_object(object);
  operation.mutable_set_vertices()->set_positions(bytesOf(positions));
  operation.mutable_set_vertices()->set_normals(bytesOf(normals));
  return operation;
}

v1::Operation deleteLight(const std::string& name) {
  v1::Operation operation;
  operation.set_delete_light(name);
  return operation;
}

v1::Operation deleteSurface(const std::string& name) {
  v1::Operation operation;
  operation.set_delete_surface(name);
  return operation;
}

v1::Operation deleteCamera(const std::string& name) {
  v1::Operation operation;
  operation.set_delete_camera(name);
  return operation;
}

v1::Operation fitGrid() {
  v1::Operation operation;
  operation.mutable_fit_grid();
  return operation;
}

}  // namespace lpv::client
