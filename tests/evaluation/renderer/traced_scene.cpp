#include "renderer/traced_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lpv::evaluation {

namespace {

constexpr double kOffset = 4e-6;  ///< of coordinates and extents: some 30 steps of a float

template <typename Value>
Value mix(const Value& a, const Value& b, const Value& c, double u, double v) {
  return (1.0 - u - v) * a + u * b + v * c;
}

RTCRayHit rayOf(const glm::dvec3& origin, const glm::dvec3& direction, double from, double to) {
  RTCRayHit ray{};
  ray.ray.org_x = float(origin.x);
  ray.ray.org_y = float(origin.y);
  ray.ray.org_z = float(origin.z);
  ray.ray.dir_x = float(direction.x);
  ray.ray.dir_y = float(direction.y);
  ray.ray.dir_z = float(direction.z);
  ray.ray.tnear = float(from);
  ray.ray.tfar = float(to);
  ray.ray.mask = ~0U;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

/// Rec. 709.
double luminance(const glm::dvec3& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

/// How bright a light's texture is over a triangle, about, and never none: any point of it may be chosen.
double brightness(const TracedObject& object, const glm::uvec3& t) {
  if (!object.texture) return 1.0;
  constexpr int kSteps = 8;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps - i; ++j) {
      const double u = (i + 1.0 / 3.0) / kSteps, v = (j + 1.0 / 3.0) / kSteps;
      sum += luminance(object.texture->at(mix(object.uvs[t.x], object.uvs[t.y], object.uvs[t.z], u, v)));
    }
  }
  constexpr double kLeast = 0.05;  // of the whole texture's
  return std::max(sum / (0.5 * kSteps * (kSteps + 1)), kLeast * luminance(object.texture->mean()));
}

}  // namespace

TracedScene::TracedScene(const Scene& scene)
    : device_(rtcNewDevice("threads=1")), all_(rtcNewScene(device_)), lights_(rtcNewScene(device_)) {
  for (const auto& [name, light] : scene.lights) {
    if (!light->enabled) continue;
    TracedObject object;
    object.emits = true;
    object.twoSided = light->twoSided;
    object.distant = light->distant;
    object.colour = emittedRadiance(*light);
    object.texture = linear(light->texture, *light->mesh);
    add(*light->mesh, light->transform, std::move(object));
  }
  for (const auto& [name, surface] : scene.surfaces) {
    TracedObject object;
    object.twoSided = surface->twoSided;
    object.colour = surface->albedo;
    object.finish = {surface->roughness, surface->metalness};
    object.gloss = linear(surface->glossTexture, *surface->mesh);
    object.texture = linear(surface->albedoTexture, *surface->mesh);
    add(*surface->mesh, surface->transform, std::move(object));
  }
  const Bounds bounds = contentBounds(scene);
  if (!bounds.empty()) size_ = std::max({bounds.extent().x, bounds.extent().y, bounds.extent().z});
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    attach(all_, i);
    if (objects_[i].emits) attach(lights_, i);
  }
  rtcCommitScene(all_);
  rtcCommitScene(lights_);
  chooseLightsByPower();
}

TracedScene::~TracedScene() {
  rtcReleaseScene(all_);
  rtcReleaseScene(lights_);
  rtcReleaseDevice(device_);
}

std::shared_ptr<const LinearTexture> TracedScene::linear(const TexturePtr& texture, const Mesh& mesh) {
  if (texture == nullptr || mesh.uvs.empty()) return nullptr;
  auto& known = textures_[texture.get()];
  if (known == nullptr) known = std::make_shared<const LinearTexture>(*texture);
  return known;
}

void TracedScene::add(const Mesh& mesh, const Transform& transform, TracedObject object) {
  const glm::dmat4 world = transform.worldFromObject();
  const glm::dmat3 normalMatrix = glm::transpose(glm::inverse(glm::dmat3(world)));
  for (const glm::vec3& p : mesh.positions) object.positions.emplace_back(world * glm::dvec4(glm::dvec3(p), 1.0));
  for (const glm::vec3& n : mesh.normals) object.normals.push_back(glm::normalize(normalMatrix * glm::dvec3(n)));
  for (const glm::vec2& uv : mesh.uvs) object.uvs.emplace_back(uv);
  object.triangles = mesh.triangles;
  if (transform.mirrors()) {
    for (glm::uvec3& t : object.triangles) std::swap(t.y, t.z);
  }
  objects_.push_back(std::move(object));
}

void TracedScene::attach(RTCScene target, std::size_t index) const {
  const TracedObject& object = objects_[index];
  const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* positions = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                3 * sizeof(float), object.positions.size()));
  for (std::size_t i = 0; i < object.positions.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) positions[3 * i + std::size_t(axis)] = float(object.positions[i][axis]);
  }
  auto* triangles = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), object.triangles.size()));
  for (std::size_t i = 0; i < object.triangles.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) triangles[3 * i + std::size_t(corner)] = object.triangles[i][corner];
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(target, geometry, unsigned(index));
  rtcReleaseGeometry(geometry);
  rtcSetSceneFlags(target, RTC_SCENE_FLAG_ROBUST);
}

std::array<glm::dvec3, 3> TracedScene::cornersOf(std::uint32_t object, std::uint32_t triangle) const {
  const TracedObject& o = objects_[object];
  const glm::uvec3& t = o.triangles[triangle];
  return {o.positions[t.x], o.positions[t.y], o.positions[t.z]};
}

void TracedScene::chooseLightsByPower() {
  double sum = 0.0;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    TracedObject& object = objects_[i];
    if (!object.emits) continue;
    object.firstEmitter = emitters_.size();
    const double weight = luminance(object.colour) * (object.twoSided ? 2.0 : 1.0);
    for (std::uint32_t t = 0; t < object.triangles.size(); ++t) {
      const auto [a, b, c] = cornersOf(i, t);
      const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
      emitters_.push_back({i, t, area, area * weight * brightness(object, object.triangles[t])});
      sum += emitters_.back().probability;
    }
  }
  if (sum <= 0.0) return;
  double below = 0.0;
  for (Emitter& emitter : emitters_) {
    emitter.probability /= sum;
    below += emitter.probability;
    cumulative_.push_back(below);
  }
}

double TracedScene::offsetAt(const glm::dvec3& p) const {
  return kOffset * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z), size_});
}

double TracedScene::past(const Hit& hit) const { return hit.distance * (1.0 + kOffset) + offsetAt(hit.position); }

Hit TracedScene::hitOf(const RTCRayHit& ray, const glm::dvec3& origin) const {
  Hit hit;
  hit.object = ray.hit.geomID;
  hit.triangle = ray.hit.primID;
  const TracedObject& object = objects_[hit.object];
  const glm::uvec3& t = object.triangles[hit.triangle];
  const auto [a, b, c] = cornersOf(hit.object, hit.triangle);
  const double u = double(ray.hit.u);
  const double v = double(ray.hit.v);
  hit.position = mix(a, b, c, u, v);
  hit.distance = double(ray.ray.tfar);
  hit.flatNormal = glm::normalize(glm::cross(b - a, c - a));
  hit.front = glm::dot(hit.flatNormal, origin - a) > 0.0;
  hit.normal = hit.flatNormal;
  if (!object.normals.empty()) {
    const glm::dvec3 n = mix(object.normals[t.x], object.normals[t.y], object.normals[t.z], u, v);
    if (glm::length(n) > 1e-6) hit.normal = glm::normalize(n);
  }
  if (!object.uvs.empty()) hit.uv = mix(object.uvs[t.x], object.uvs[t.y], object.uvs[t.z], u, v);
  return hit;
}

std::optional<Hit> TracedScene::cast(RTCScene scene, const glm::dvec3& origin, const glm::dvec3& direction, double from,
                                     double to) const {
  RTCRayHit ray = rayOf(origin, direction, from, to);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return hitOf(ray, origin);
}

std::optional<Hit> TracedScene::nearest(const glm::dvec3& origin, const glm::dvec3& direction, double from) const {
  return cast(all_, origin, direction, from, std::numeric_limits<double>::infinity());
}

std::optional<Hit> TracedScene::seen(const glm::dvec3& origin, const glm::dvec3& direction, double from,
                                     double to) const {
  while (true) {
    const std::optional<Hit> hit = cast(all_, origin, direction, from, to);
    if (!hit) {
      const std::optional<Hit> beyond =
          cast(lights_, origin, direction, std::max(from, to), std::numeric_limits<double>::infinity());
      return beyond && objects_[beyond->object].distant ? beyond : std::nullopt;
    }
    if (hit->front || objects_[hit->object].emits || objects_[hit->object].twoSided) return hit;
    from = past(*hit);
  }
}

std::vector<Hit> TracedScene::lightsAlong(const glm::dvec3& origin, const glm::dvec3& direction) const {
  std::vector<Hit> hits;
  double from = 0.0;
  while (true) {
    const auto hit = cast(lights_, origin, direction, from, std::numeric_limits<double>::infinity());
    if (!hit) return hits;
    hits.push_back(*hit);
    from = past(*hit);
  }
}

bool TracedScene::blocked(const glm::dvec3& from, const glm::dvec3& to) const {
  RTCRay ray = rayOf(from, to - from, 0.0, 1.0).ray;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(all_, &context, &ray);
  return ray.tfar < 0.0F;
}

glm::dvec3 TracedScene::coloured(const Hit& hit) const {
  const TracedObject& object = objects_[hit.object];
  return object.texture ? object.colour * object.texture->at(hit.uv) : object.colour;
}

glm::dvec3 TracedScene::emitted(const Hit& hit) const {
  const TracedObject& object = objects_[hit.object];
  return object.emits && (hit.front || object.twoSided) ? coloured(hit) : glm::dvec3(0.0);
}

glm::dvec3 TracedScene::albedo(const Hit& hit) const {
  const TracedObject& object = objects_[hit.object];
  return !object.emits && (hit.front || object.twoSided) ? coloured(hit) : glm::dvec3(0.0);
}

Finish TracedScene::finish(const Hit& hit) const {
  const TracedObject& object = objects_[hit.object];
  if (!object.gloss) return object.finish;
  const glm::dvec3 texel = object.gloss->at(hit.uv);
  return {object.finish.roughness * texel.y, object.finish.metalness * texel.z};
}

LightSample TracedScene::sampleLight(const glm::dvec2& random) const {
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), random.x * cumulative_.back());
  const auto index = std::min(std::size_t(found - cumulative_.begin()), cumulative_.size() - 1);
  const Emitter& emitter = emitters_[index];
  const TracedObject& object = objects_[emitter.object];
  // What is left of the first number within the triangle's share is as good as a new one.
  const double below = index == 0 ? 0.0 : cumulative_[index - 1];
  const double r1 = std::clamp((random.x * cumulative_.back() - below) / emitter.probability, 0.0, 1.0);
  const double u = (1.0 - random.y) * std::sqrt(r1);
  const double v = random.y * std::sqrt(r1);
  const auto [a, b, c] = cornersOf(emitter.object, emitter.triangle);
  LightSample sample;
  sample.position = mix(a, b, c, u, v);
  sample.normal = glm::normalize(glm::cross(b - a, c - a));
  sample.twoSided = object.twoSided;
  sample.density = emitter.probability / emitter.area;
  sample.radiance = object.colour;
  if (object.texture) {
    const glm::uvec3& t = object.triangles[emitter.triangle];
    sample.radiance *= object.texture->at(mix(object.uvs[t.x], object.uvs[t.y], object.uvs[t.z], u, v));
  }
  return sample;
}

double TracedScene::lightDensity(const Hit& hit) const {
  const Emitter& emitter = emitters_[objects_[hit.object].firstEmitter + hit.triangle];
  return emitter.area > 0.0 ? emitter.probability / emitter.area : 0.0;
}

}  // namespace lpv::evaluation
