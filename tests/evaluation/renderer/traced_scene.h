#pragma once
// A scene as rays see it: world triangles in Embree, and the lights' triangles as something to choose points on.

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "renderer/linear_texture.h"
#include "scene/scene.h"

namespace lpv::evaluation {

/// What a surface's lobe follows from.
struct Finish {
  double roughness = 1.0;
  double metalness = 0.0;
};

/// A light or a surface, its triangles in the world. Counter-clockwise corners are the front; a mirroring transform
/// keeps the front that the mesh has (MATHS.md 1).
struct TracedObject {
  bool emits = false;
  bool twoSided = false;
  bool distant = false;  ///< seen behind everything, however near the camera's far end is
  glm::dvec3 colour{0.0};  ///< radiance in W/(sr m^2), or albedo
  Finish finish;
  std::shared_ptr<const LinearTexture> texture;  ///< multiplies it, or null
  std::shared_ptr<const LinearTexture> gloss;  ///< its green multiplies roughness, its blue metalness; or null
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;  ///< unit, or empty: flat
  std::vector<glm::dvec2> uvs;      ///< or empty
  std::vector<glm::uvec3> triangles;
  std::size_t firstEmitter = 0;     ///< of a light: where its triangles begin in the list of all lights' triangles
};

/// Where a ray meets a triangle.
struct Hit {
  std::uint32_t object = 0;
  std::uint32_t triangle = 0;
  bool front = true;        ///< the ray comes from the triangle's front
  double distance = 0.0;    ///< metres along the ray
  glm::dvec3 position{0.0};
  glm::dvec3 flatNormal{0.0};  ///< unit, of the triangle's front
  glm::dvec3 normal{0.0};      ///< unit, interpolated, of the front
  glm::dvec2 uv{0.0};
};

/// A point on a light, chosen evenly over the area of a triangle that was chosen by its power.
struct LightSample {
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0};    ///< unit, of the front
  glm::dvec3 radiance{0.0};  ///< W/(sr m^2), of a side that emits
  bool twoSided = false;
  double density = 0.0;      ///< per m^2
};

class TracedScene {
 public:
  /// Enabled lights first, then surfaces, in the scene's order.
  explicit TracedScene(const Scene& scene);
  ~TracedScene();
  TracedScene(const TracedScene&) = delete;
  TracedScene& operator=(const TracedScene&) = delete;

  /// Nearest hit farther than `from` metres.
  std::optional<Hit> nearest(const glm::dvec3& origin, const glm::dvec3& direction, double from = 0.0) const;
  /// Nearest hit between the distances that a camera sees: backs of one-sided surfaces are not drawn, those of lights
  /// are, and distant lights wherever nothing else is.
  std::optional<Hit> seen(const glm::dvec3& origin, const glm::dvec3& direction, double from, double to) const;
  /// All lights that a ray meets, whatever stands between.
  std::vector<Hit> lightsAlong(const glm::dvec3& origin, const glm::dvec3& direction) const;
  bool blocked(const glm::dvec3& from, const glm::dvec3& to) const;

  /// What the side of a light that was hit emits; 0 for a surface and for the back of a one-sided light.
  glm::dvec3 emitted(const Hit& hit) const;
  /// 0 for a light, which reflects nothing, and for the back of a one-sided surface.
  glm::dvec3 albedo(const Hit& hit) const;

  /// Where it was hit.
  Finish finish(const Hit& hit) const;

  bool hasLights() const { return !cumulative_.empty(); }
  LightSample sampleLight(const glm::dvec2& random) const;
  /// Density per m^2 with which sampleLight chooses the point that was hit.
  double lightDensity(const Hit& hit) const;

  const std::vector<TracedObject>& objects() const { return objects_; }
  /// Distance from a surface, metres, at which rays begin and end: coordinates are floats in Embree, and a ray may
  /// cross the whole scene.
  double offsetAt(const glm::dvec3& position) const;

 private:
  void add(const Mesh& mesh, const Transform& transform, TracedObject object);
  void attach(RTCScene target, std::size_t object) const;
  void chooseLightsByPower();
  /// The distance from which a ray goes on behind a hit.
  double past(const Hit& hit) const;
  Hit hitOf(const RTCRayHit& ray, const glm::dvec3& origin) const;
  std::optional<Hit> cast(RTCScene scene, const glm::dvec3& origin, const glm::dvec3& direction, double from,
                          double to) const;
  std::shared_ptr<const LinearTexture> linear(const TexturePtr& texture, const Mesh& mesh);
  std::array<glm::dvec3, 3> cornersOf(std::uint32_t object, std::uint32_t triangle) const;
  glm::dvec3 coloured(const Hit& hit) const;

  struct Emitter {
    std::uint32_t object;
    std::uint32_t triangle;
    double area;
    double probability;
  };

  RTCDevice device_;
  RTCScene all_;
  RTCScene lights_;
  std::vector<TracedObject> objects_;
  std::vector<Emitter> emitters_;
  std::vector<double> cumulative_;
  std::map<const Texture*, std::shared_ptr<const LinearTexture>> textures_;
  double size_ = 0.0;  ///< largest extent of the bounds, metres
};

}  // namespace lpv::evaluation
