#pragma once
// A session's scene as ticks read it: immutable objects behind shared pointers, so that a snapshot is a copy of
// pointers and a tick never sees half an edit.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "scene/camera.h"
#include "scene/grid.h"
#include "scene/light_points.h"
#include "scene/mesh.h"
#include "scene/options.h"
#include "scene/texture.h"
#include "scene/transform.h"

namespace lpv {

/// Distinct groups among the lights of a scene: a volume's layers.
inline constexpr int kMaxGroups = 8;

struct Light;
using LightPtr = std::shared_ptr<const Light>;

/// A mesh that emits from its front side (both when twoSided) with constant radiance times the texture.
struct Light {
  std::string name;
  MeshPtr mesh;
  Transform transform;
  glm::dvec3 radiance{1.0};             ///< linear Rec.709, W/(sr m^2), >= 0; ignored when power is set
  std::optional<glm::dvec3> power;      ///< W per colour over the whole mesh; radiance = power / (pi area sides)
  TexturePtr texture;                   ///< radiance multiplier, or null
  bool twoSided = false;
  bool enabled = true;
  std::string group;                    ///< light group (a volume layer); "" is the default
  bool castsShadow = true;              ///< blocks its own light where it is not convex
  bool visibleToCamera = true;          ///< shown in frames
  bool distant = false;  ///< so far away that its light comes from the same directions everywhere; unit: the distance
  LightPtr placedFrom;  ///< of a scene's distant lights, which are in parts: what the session has (distant_lights.h)
  LightPointsPtr points;  ///< of such a part: where shadow rays go; null: as lightPoints spreads them
};

/// The name that the session has for a light that a scene has by `name`.
const std::string& sessionName(const std::string& name, const Light& light);
/// Where shadow rays go, object space.
LightPointsPtr pointsOf(const Light& light);

/// Radiance in W/(sr m^2) that the light's front emits, from `radiance` or `power`; 0 for a mesh without area.
glm::dvec3 emittedRadiance(const Light& light);

/// How alpha is read: the numbers of scene.proto.
enum class AlphaMode {
  kOpaque = 1,  ///< 1 everywhere
  kMask = 2,  ///< 1 from alphaCutoff on, else 0
  kBlend = 3,  ///< as it is
};

/// A mesh that receives light, blocks and reflects it. Alpha is opacity x the texture's; the surface reflects alpha x
/// albedo and lets (1 - alpha) x transmission through (scene/transparency.h).
struct Surface {
  std::string name;
  MeshPtr mesh;
  Transform transform;
  glm::dvec3 albedo{0.8};  ///< linear Rec.709 reflectance, 0..1
  TexturePtr albedoTexture;  ///< multiplies albedo, or null
  TexturePtr normalTexture;  ///< tangent-space normals that frames show, or null
  double normalScale = 1.0;  ///< how much these bend, 0..16
  double roughness = 1.0;  ///< 0..1
  double metalness = 0.0;  ///< 0..1
  TexturePtr glossTexture;  ///< its green multiplies roughness, its blue metalness, in frames; or null
  bool twoSided = true;  ///< false: seen and lit from its front only
  bool castsShadow = true;  ///< stands in the way of light
  bool visibleToCamera = true;  ///< shown in frames
  AlphaMode alphaMode = AlphaMode::kOpaque;
  double alphaCutoff = 0.5;  ///< 0..1
  double opacity = 1.0;  ///< 0..1
  glm::dvec3 transmission{1.0};  ///< linear Rec.709, 0..1
};

using SurfacePtr = std::shared_ptr<const Surface>;

/// All that a surface wears: albedo, normals, gloss. Each may be null.
std::array<TexturePtr, 3> texturesOf(const Surface& surface);

/// One revision of a session's scene. Maps are ordered by name: order of work is the same everywhere.
struct Scene {
  std::uint64_t revision = 0;
  LightingSettings options;
  Grid grid;  ///< fitted or given; valid dims
  std::map<std::string, LightPtr> lights;  ///< distant ones as placeDistantLights leaves them
  std::map<std::string, SurfacePtr> surfaces;
  std::map<std::string, Camera> cameras;  ///< cameras that came with a scene file or were saved
};
using ScenePtr = std::shared_ptr<const Scene>;

/// World bounds of all surfaces and enabled lights that are not distant.
Bounds contentBounds(const Scene& scene);

}  // namespace lpv
