#pragma once
// Messages of geometry.proto to domain values and back. Conversions check presence and finiteness; ranges are checked
// by the domain.

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "lpv/v1/geometry.pb.h"
#include "scene/camera.h"
#include "scene/edits.h"
#include "scene/grid.h"

namespace lpv::api {

namespace pb = lpv::v1;

glm::dvec3 fromProto(const pb::Vec3& v);
glm::dquat fromProto(const pb::Quaternion& q);
Bounds fromProto(const pb::Box& box);
/// Unset numbers take their documented defaults; checked.
Expected<Camera> fromProto(const pb::Camera& camera);
/// The fields of `transform` that a mask path or a new object names: all that are set, or the matrix.
Expected<TransformFields> fromProto(const pb::Transform& transform);

void toProto(const glm::dvec3& v, pb::Vec3* out);
void toProto(const Transform& transform, pb::Transform* out);
void toProto(const Grid& grid, pb::Grid* out);
void toProto(const Bounds& bounds, pb::Box* out);
void toProto(const std::string& name, const Camera& camera, pb::Camera* out);

}  // namespace lpv::api
