#pragma once
// Patches of the surfaces, from which light is reflected (MATHS.md 6, invariant 13): points that stand for the area
// around them, on each side that can be lit.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "scene/scene.h"

namespace lpv {

/// A bit for each of layout::kPatchPlaces places of a triangle.
inline constexpr std::uint32_t kAllPlaces = 0xFFFFU;

/// World space, metres.
struct Patch {
  glm::vec3 position{0.0F};
  float area = 0.0F;       ///< m^2
  glm::vec3 normal{0.0F};  ///< unit, of the side that it is on
  glm::vec3 albedo{0.0F};  ///< mean of alpha x albedo around it
  std::optional<std::array<glm::vec3, 3>>
      triangle;  ///< counter-clockwise seen from its side; none: it stands for several
  std::uint32_t places = kAllPlaces;  ///< of a triangle, a bit for each of its places that it stands for
                                      ///< (scene/parted_patches.h); `area` is of these
  float reach = 0.0F;  ///< 0, or it stands for small triangles that have pieces (Folds): metres from it in which
                       ///< receivers look for these
};

/// Small triangles, for which one of many stands among the patches, in finer pieces: what is near to them sees these
/// (MATHS.md 3d.7). Of surfaces that stop all light, so that a ray that sees a piece ends there.
struct Folds {
  struct Range {
    std::uint32_t first = 0, count = 0;  ///< pieces
  };
  struct OfSurface {
    std::vector<Range>
        triangles;  ///< by triangle of the mesh, its front; none where it is no small one. Empty: none is
    std::uint32_t toBack = 0;  ///< from a piece of the front to the same of the back; 0: it is not lit there
  };
  std::vector<Patch> pieces;
  std::vector<std::uint32_t> patchOf;  ///< by piece: the patch that stands for it
  std::vector<OfSurface> surfaces;  ///< of the scene, in the order of names; empty without pieces
};

struct PatchedScene {
  std::vector<Patch> patches;
  Folds folds;
};
using PatchedScenePtr = std::shared_ptr<const PatchedScene>;

/// How large pieces of a scene's triangles may be, in steps of four, so that a light that moves a little leaves them as
/// they are.
struct PieceSizes {
  static constexpr std::int8_t kAny = 127;
  /// By surface, in the order of names, and by triangle of patchedTriangles(): e for 4^e m^2. Empty: kAny for all.
  std::vector<std::vector<std::int8_t>> exponents;

  /// m^2; infinite where no light is near. `coarser`: exponents are so much higher.
  double most(std::size_t surface, std::size_t triangle, int coarser) const;
  bool operator==(const PieceSizes&) const = default;
};

using PieceSizesPtr = std::shared_ptr<const PieceSizes>;

/// From where light may come: out of the box around a scene's surfaces, and from those of its six sides that lights are
/// beyond. From all six without lights, or with a sky.
struct LitSpace {
  Bounds surfaces;
  std::array<std::array<bool, 3>, 2> open = {{{true, true, true}, {true, true, true}}};  ///< down and up, by axis

  bool operator==(const LitSpace&) const = default;
};
LitSpace litSpace(const Scene& scene);

/// Patches of a scene's surfaces by quality, about.
inline constexpr std::size_t kFastPatches = 1024;
inline constexpr std::size_t kAccuratePatches = 2048;
/// The pieces of folds, by quality.
inline constexpr std::size_t kFastPieces = 32768;
inline constexpr std::size_t kAccuratePieces = 65536;

/// The triangles of a surface that patches are made of: those of its mesh, flat ones merged where its albedo is even.
const std::vector<glm::uvec3>& patchedTriangles(const Surface& surface);

/// No piece of a scene's folds has a larger area, m^2.
double largestPiece(const Scene& scene, std::size_t pieces);

/// About `count`, of about the same area: large triangles are cut evenly, of small ones some stand for their
/// neighbours. Every surface has one for each of its sides at least, unless there are more surfaces than half of
/// `count`; twice `count` are the most. No large triangle has any on a side to which no light comes, such as the
/// outside of a room. The same surfaces and litSpace() give the same patches.
std::vector<Patch> patchesOf(const Scene& scene, std::size_t count);
/// The same patches with about `pieces` of their folds, and some for each patch in which triangles face many ways; with
/// smaller ones where `sizes` asks for them, up to three times as many.
PatchedScene patchedScene(const Scene& scene, std::size_t count, std::size_t pieces, const PieceSizes& sizes = {});

/// The number of bounces after which what light is still under way is less than a third of the wanted error, bounded by
/// the highest albedo; `bounces` itself where it is not kAutoBounces. 0 without surfaces that reflect.
int bouncesFor(const Scene& scene);

/// How light between surfaces is found: turns, in each of which every patch gathers from all others.
struct BouncePlan {
  int turns = 0;
  double albedo = 0.0;  ///< 0: a turn is a bounce. Else the highest, and turns are weighed: fewer come as near

  /// By how much turn `turn`, counted from 0, goes from what was there two turns before to what it has gathered: those
  /// of Chebyshev's semi-iteration, for which the exchange's eigenvalues lie within the albedo to both sides of 0
  /// (Golub and Varga 1961). 1 for a bounce.
  double weight(int turn) const;

  bool operator==(const BouncePlan&) const = default;
};

/// For kAutoBounces as few turns as leave a third of the light that bouncesFor() bounces may: what they leave is
/// uneven, and shows in dark places. After n of them 1 / T_n(1 / albedo) is left at most, T_n Chebyshev's polynomial:
/// for albedo .8 and 3 % 9 turns and not 20 bounces.
BouncePlan bouncePlan(const Scene& scene);

}  // namespace lpv
