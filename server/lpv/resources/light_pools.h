#pragma once
// Where shadow rays go: points of the lights' surfaces on the GPU, pool by pool (MATHS.md 3d).

#include <cstddef>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "lpv/resources/lights.h"
#include "scene/light_points.h"

namespace lpv {

/// Lights that are looked at together: a receiver has one irradiance and one visible share of each pool.
struct LightPool {
  int firstLight = 0;  ///< of the lights in the order of names
  int lightsEnd = 0;   ///< one past the last
  int firstPoint = 0;
  int points = 0;
  double area = 0.0;   ///< of one side, cells^2
  double power = 0.0;  ///< sum over one side of area times the brightest channel of radiance
  bool distant = false;  ///< all of its lights are: seen through windows, of which rays miss many
};

/// Their numbers, those of the most power first.
std::vector<std::size_t> brightestFirst(std::span<const LightPool> pools);

/// Lights in so many pools at most: each its own, while there are no more.
inline constexpr std::size_t kMostPools = 16;

/// As many points of a light of many polygons, or with a picture, as shadow rays choose from, for what sees only some
/// of a light at a time, a lobe or a view through haze beside it: it would meet the same few however long it looks.
inline constexpr std::size_t kFineTimes = 16;
/// Of so many lights: of more, fewer of each.
inline constexpr std::size_t kMostFineLights = 16;

/// The points of meshes in object space, kept while lights have them.
class LightPointCache {
 public:
  /// From now on `times` as many of lights that have more than few polygons, or a picture.
  void setTimes(std::size_t times);
  LightPointsPtr get(const EmittingLight& light);
  /// Lets go of what was not asked for since the last call.
  void sweep();

 private:
  struct Kept {
    LightPointsPtr points;
    bool used = false;
  };
  std::size_t times_ = 1;
  std::map<std::pair<MeshPtr, TexturePtr>, Kept> kept_;
};

struct LightPools {
  std::vector<LightPool> pools;
  std::vector<LightPool> ranges;  ///< each light by itself
  gpu::Buffer texels;  ///< as shaders/visibility/light_points.glsl has them
  gpu::BufferTexture view;

  void make(const std::vector<EmittingLight>& lights, LightPointCache& cache);
};

}  // namespace lpv
