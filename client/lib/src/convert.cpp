#include "lpv/convert.h"

#include <bit>
#include <vector>

namespace lpv::client {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays travel as the machine holds them");

template <typename T>
std::string bytesOf(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

}  // namespace

v1::Vec3 toProto(const glm::dvec3& v) {
  v1::Vec3 out;
  out.set_x(v.x);
  out.set_y(v.y);
  out.set_z(v.z);
  return out;
}

v1::Quaternion toProto(const glm::dquat& q) {
  v1::Quaternion out;
  out.set_x(q.x);
  out.set_y(q.y);
  out.set_z(q.z);
  out.set_w(q.w);
  return out;
}

v1::Transform toProto(const Transform& transform) {
  v1::Transform out;
  *out.mutable_translation() = toProto(transform.translation);
  *out.mutable_rotation() = toProto(transform.rotation);
  *out.mutable_scale() = toProto(transform.scale);
  return out;
}

v1::Camera toProto(const Camera& camera, const std::string& name) {
  v1::Camera out;
  out.set_name(name);
  *out.mutable_eye() = toProto(camera.eye);
  *out.mutable_target() = toProto(camera.target);
  *out.mutable_up() = toProto(camera.up);
  out.set_fov_degrees(camera.fovDegrees);
  out.set_near(camera.near);
  out.set_far(camera.far);
  return out;
}

v1::Mesh toProto(const Mesh& mesh) {
  v1::Mesh out;
  out.set_positions(bytesOf(mesh.positions));
  out.set_indices(bytesOf(mesh.triangles));
  out.set_normals(bytesOf(mesh.normals));
  out.set_uvs(bytesOf(mesh.uvs));
  out.set_directions(bytesOf(mesh.directions));
  return out;
}

v1::Texture toProto(const Texture& texture) {
  v1::Texture out;
  out.set_width(texture.width);
  out.set_height(texture.height);
  switch (texture.format) {
    case TexelFormat::kRgb8Srgb:
      out.set_format(v1::TEXTURE_FORMAT_RGB8_SRGB);
      break;
    case TexelFormat::kRgb16F:
      out.set_format(v1::TEXTURE_FORMAT_RGB16F);
      break;
    case TexelFormat::kRgb32F:
      out.set_format(v1::TEXTURE_FORMAT_RGB32F);
      break;
    case TexelFormat::kRgba8Srgb:
      out.set_format(v1::TEXTURE_FORMAT_RGBA8_SRGB);
      break;
    case TexelFormat::kRgb8:
      out.set_format(v1::TEXTURE_FORMAT_RGB8_LINEAR);
      break;
  }
  out.set_texels(bytesOf(texture.texels));
  return out;
}

glm::dvec3 fromProto(const v1::Vec3& v) { return {v.x(), v.y(), v.z()}; }

Transform fromProto(const v1::Transform& transform) {
  Transform out;
  if (transform.has_translation()) out.translation = fromProto(transform.translation());
  if (transform.has_rotation()) {
    const v1::Quaternion& q = transform.rotation();
    out.rotation = glm::dquat(q.w(), q.x(), q.y(), q.z());
  }
  if (transform.has_scale()) out.scale = fromProto(transform.scale());
  return out;
}

Camera fromProto(const v1::Camera& camera) {
  Camera out;
  out.eye = fromProto(camera.eye());
  out.target = fromProto(camera.target());
  out.setUpByView();
  if (camera.has_up()) out.up = fromProto(camera.up());
  if (camera.fov_degrees() != 0.0) out.fovDegrees = camera.fov_degrees();
  out.setRangeByDistance();
  if (camera.near() != 0.0) out.near = camera.near();
  if (camera.far() != 0.0) out.far = camera.far();
  return out;
}

Grid fromProto(const v1::Grid& grid) {
  return {fromProto(grid.origin()), grid.cell_size(), {grid.dims().x(), grid.dims().y(), grid.dims().z()}};
}

Lookup fromProto(v1::Lookup lookup) {
  switch (lookup) {
    case v1::LOOKUP_SH2:
      return Lookup::kSh2;
    case v1::LOOKUP_NEAREST:
      return Lookup::kNearest;
    default:
      return Lookup::kCap;
  }
}

}  // namespace lpv::client
