#pragma once
// Between the wire's messages and the domain's values.

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
/// Unset fields mean identity; `matrix` is not looked at (the server never sends it).
Transform fromProto(const v1::Transform& transform);
/// Unset fields take the documented defaults.
Camera fromProto(const v1::Camera& camera);
/// As sent; the numbers are not checked.
Grid fromProto(const v1::Grid& grid);
/// How a session reads irradiance, for lpv::irradianceAt; CAP where a message does not say.
Lookup fromProto(v1::Lookup lookup);

}  // namespace lpv::client
