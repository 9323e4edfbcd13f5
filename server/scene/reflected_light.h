#pragma once
// What surfaces reflect, as probes on the CPU see it. The GPU's twin is shaders/frame/patch_light.comp.

#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "scene/light_visibility.h"
#include "scene/patches.h"

namespace lpv {

struct LightAround;  // scene/light_around.h

// As in shaders/visibility/patch_weight.glsl: nearer patches, by the square of the distance over their area, are the
// triangles that they are; and what their area times this is, is four times their variance along an axis.
inline constexpr double kNearPatch = 9.0;
inline constexpr double kPatchSizeOfArea = 0.44;

struct ReflectedLight {
  PatchedScenePtr of;
  std::vector<glm::dvec3> radiance;  ///< W/(sr m^2), per patch
  std::vector<glm::dvec3> slopes;  ///< how it changes across triangles, per metre, over the radiance; empty: not
  std::vector<glm::dvec3> pieceRadiance;  ///< the same, per piece of the folds
  std::vector<Folds::Range> piecesOf;     ///< by patch; empty without pieces
  std::vector<double> sentUpTo;           ///< by piece: what those of its patch up to it send together

  /// Finds the last two.
  void findPiecesOfPatches();

  /// W/m^2 at a world position on a surface with unit normal n; `visibility`: null where nothing stands in the way.
  /// Rays go to some of the patches, in proportion to what they send, to places of triangles, and of those with pieces
  /// to one of these; folds that are near are looked for all around.
  glm::dvec3 irradiance(const glm::dvec3& at, const glm::dvec3& n, const LightVisibility* visibility) const;

  /// All around a world position that is on no surface.
  LightAround around(const glm::dvec3& at, const LightVisibility* visibility) const;

 private:
  /// The k-th of the places on a triangle that rays of one receiver go to: of near ones in proportion to what each
  /// would send there.
  glm::dvec3 placeOn(std::size_t patch, int k, const glm::dvec3& at, const glm::dvec3& n) const;
  /// What is sent at a place of a patch, over its mean.
  double sentAt(std::size_t patch, const glm::dvec3& place) const;
  /// A piece of a patch, `u` in [0, 1) of what they send.
  std::optional<std::size_t> pieceOf(std::size_t patch, double u) const;
  /// What a sight shows of pieces whose patches are near: their radiance, as much of it as they stand for.
  std::optional<glm::dvec3> pieceAt(const LightVisibility::Sight& sight, const glm::dvec3& at) const;
  glm::dvec3 fromPieces(const glm::dvec3& at, const glm::dvec3& n, const LightVisibility& visibility) const;
};
using ReflectedLightPtr = std::shared_ptr<const ReflectedLight>;

}  // namespace lpv
