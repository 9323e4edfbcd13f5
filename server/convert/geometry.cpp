#include "convert/geometry.h"

namespace lpv::api {

glm::dvec3 fromProto(const pb::Vec3& v) { return {v.x(), v.y(), v.z()}; }

glm::dquat fromProto(const pb::Quaternion& q) { return {q.w(), q.x(), q.y(), q.z()}; }

Bounds fromProto(const pb::Box& box) { return {fromProto(box.min()), fromProto(box.max())}; }

Expected<Camera> fromProto(const pb::Camera& in) {
  if (!in.has_eye()) return invalid("eye", "camera.eye is not set");
  if (!in.has_target()) return invalid("target", "camera.target is not set");
  Camera camera;
  camera.eye = fromProto(in.eye());
  camera.target = fromProto(in.target());
  camera.setUpByView();
  if (in.has_up()) camera.up = fromProto(in.up());
  if (in.fov_degrees() != 0.0) camera.fovDegrees = in.fov_degrees();
  camera.setRangeByDistance();
  if (in.near() != 0.0) camera.near = in.near();
  if (in.far() != 0.0) camera.far = in.far();
  if (Status s = checkCamera(camera); !s.ok()) return s;
  return camera;
}

Expected<TransformFields> fromProto(const pb::Transform& in) {
  TransformFields out;
  if (in.matrix_size() != 0) {
    if (in.matrix_size() != 16) {
      return invalid("matrix", "transform.matrix has " + std::to_string(in.matrix_size()) + " numbers, needed are 16");
    }
    if (in.has_translation() || in.has_rotation() || in.has_scale()) {
      return invalid("matrix", "transform.matrix is set beside translation, rotation or scale; give one form");
    }
    glm::dmat4 m;
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = in.matrix(i);
    const Expected<Transform> transform = transformFromMatrix(m);
    if (!transform) return transform.status();
    return TransformFields{transform->translation, transform->rotation, transform->scale};
  }
  if (in.has_translation()) out.translation = fromProto(in.translation());
  if (in.has_rotation()) out.rotation = fromProto(in.rotation());
  if (in.has_scale()) out.scale = fromProto(in.scale());
  return out;
}

void toProto(const glm::dvec3& v, pb::Vec3* out) {
  out->set_x(v.x);
  out->set_y(v.y);
  out->set_z(v.z);
}

void toProto(const Transform& transform, pb::Transform* out) {
  toProto(transform.translation, out->mutable_translation());
  pb::Quaternion* q = out->mutable_rotation();
  q->set_x(transform.rotation.x);
  q->set_y(transform.rotation.y);
  q->set_z(transform.rotation.z);
  q->set_w(transform.rotation.w);
  toProto(transform.scale, out->mutable_scale());
}

void toProto(const Grid& grid, pb::Grid* out) {
  toProto(grid.origin, out->mutable_origin());
  out->set_cell_size(grid.cell);
  out->mutable_dims()->set_x(grid.dims.x);
  out->mutable_dims()->set_y(grid.dims.y);
  out->mutable_dims()->set_z(grid.dims.z);
}

void toProto(const Bounds& bounds, pb::Box* out) {
  toProto(bounds.min, out->mutable_min());
  toProto(bounds.max, out->mutable_max());
}

void toProto(const std::string& name, const Camera& camera, pb::Camera* out) {
  out->set_name(name);
  toProto(camera.eye, out->mutable_eye());
  toProto(camera.target, out->mutable_target());
  toProto(camera.up, out->mutable_up());
  out->set_fov_degrees(camera.fovDegrees);
  out->set_near(camera.near);
  out->set_far(camera.far);
}

}  // namespace lpv::api
