#pragma once
// Converts between messages of lpv.v1 and the domain's types.

#include <glm/glm.hpp>

#include "lpv/v1/blob.pb.h"
#include "lpv/v1/geometry.pb.h"
#include "lpv/v1/result.pb.h"
#include "lpv/v1/session.pb.h"
#include "scene/camera.h"
#include "scene/grid.h"
#include "scene/mesh.h"
#include "scene/options.h"
#include "scene/texture.h"
#include "scene/transform.h"
#include "scene/volume.h"

namespace lpv::client {

v1::Vec3 toProto(const glm::dvec3& v);
v1::Quaternion toProto(const glm::dquat& q);
v1::Transform toProto(const Transform& transform);
v1::Camera toProto(const Camera& camera, const std::string& name = {});
v1::Mesh toProto(const Mesh& mesh);
v1::Texture toProto(const Texture& texture);

glm::dvec3 fromProto(const v1::Vec3& v);
/// Unset fields mean identity. `matrix` is ignored: the server never sends it.
Transform fromProto(const v1::Transform& transform);
/// Unset fields take the defaults documented in geometry.proto.
Camera fromProto(const v1::Camera& camera);
/// Copies the numbers without checking them.
Grid fromProto(const v1::Grid& grid);
/// The lookup for lpv::irradianceAt; CAP if unspecified.
Lookup fromProto(v1::Lookup lookup);

}  // namespace lpv::client
