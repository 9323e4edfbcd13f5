#pragma once
// Stage: what the lights themselves send to the pixels of a picture, evaluated at some of them and interpolated
// between, or at each; with shadow rays where something can stand in the way (GATHER, DIRECT; MATHS.md 3c, 3d).

#include "gpu/buffer.h"
#include "gpu/program.h"
#include "gpu/texture.h"
#include "lpv/cached.h"
#include "lpv/frame/emitters.h"
#include "lpv/frame/gbuffer.h"
#include "lpv/frame/subpixels.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/incident_textures.h"
#include "lpv/resources/light_pools.h"
#include "lpv/resources/lights.h"
#include "lpv/resources/occluders.h"
#include "lpv/resources/patch_set.h"
#include "lpv/transport/emitter_list.h"

namespace lpv {

/// What a pool of lights, or what surfaces reflect, sends to a picture is made from.
struct PoolPictureInputs {
  Stamp picture = 0;                ///< of the G-buffer
  Stamp blockers = 0;               ///< what blocks all lights
  Stamp reflected = 0;              ///< what surfaces reflect; 0: lights
  Grid grid;                        ///< of positions
  std::vector<LookedAtLight> lights;
  double openingRatio = 0.0;
  int turns = 0;

  bool operator==(const PoolPictureInputs&) const = default;
};

/// RGBA32F: E in W/m^2 with shadows, and 1 where a surface is.
using PoolPicture = Cached<PoolPictureInputs, gpu::Texture>;

/// Irradiance from the lights themselves in every pixel that looks at them.
struct NearFieldBuffer {
  explicit NearFieldBuffer(const glm::ivec2& size);
  void keepShadows();  ///< makes `shadows`, once

  glm::ivec2 size;
  gpu::Texture irradiance;  ///< RGBA32F: E in W/m^2, and its weight beside the volume's: 0 far from lights
  gpu::Buffer tiles;        ///< uint per tile: 1 where it has near pixels
  gpu::Buffer points;       ///< ListHeader, then those to be evaluated, in fours
  ShadowPoints shadows;     ///< made where pools of lights are looked at
  gpu::Texture poolLight, poolShare;  ///< RGBA32F: what one pool sends, unless something is in the way, and which share
                                      ///< of it arrives; made where shares are smoothed
  std::vector<PoolPicture> pools;  ///< of a reduced picture: each keeps its own while it stands
};

/// Where lights are, as receivers look at them.
struct NearLights {
  const EmitterBufferList* emitters = nullptr;
  const gpu::Texture* emitterDistance = nullptr;  ///< null: pixels look at the lights everywhere
};

/// What stands in the lights' way, and what surfaces reflect.
struct ShadowCasters {
  const LightPools* pools = nullptr;
  const GpuOccluders* occluders = nullptr;
  int turns = 1;  ///< of four rays to each pool, at most; 0: nothing stands in the way
  const PatchSet* reflected = nullptr;  ///< null: nothing
  int reflectedTurns = 0;  ///< of rays to `reflected`, as `turns`
  int foldTurns = 0;  ///< of rays all around, to pieces of folds, where `reflectedTurns` are sent
};

/// What a picture's pixels look at, and how many of them do.
struct NearFieldSources {
  NearLights lights;
  const ShadowCasters* shadows = nullptr;  ///< null: nothing stands in the way
  bool reduced = true;  ///< some pixels look, others lie between; else each does
  int lattice = 1;  ///< of an unreduced picture: pixels from one that looks at what surfaces reflect to the next
  int firstRow = 0;  ///< of the pixels, in the picture that they are some rows of
  /// Of a reduced picture with shadows or bounces: what each pool's part of it is made from, last what surfaces
  /// reflect. Empty: all pools are looked at together.
  std::vector<PoolPictureInputs> pools;
};

/// Places that the reflections of a picture's pixels have met (lpv/frame/gloss.h), where E is wanted.
struct MetPlaces {
  const gpu::Buffer& points;  ///< layout::kGlossPoints
  const gpu::Buffer& list;  ///< layout::kNearFieldPoints
  double count;  ///< on it, at most
  ShadowPoints& shadows;  ///< as many
  const gpu::Texture& irradiance;  ///< RGBA32F: where E goes
  const gpu::Buffer& frameParams;
  int firstRow;  ///< of the pixels, in the picture that they are some rows of
};

/// Places of samples of a picture's pixels that are lit as no pixel's middle (lpv/frame/subpixels.h).
struct ApartPlaces {
  const ApartBuffer& apart;
  const gpu::Buffer& frameParams;
  int firstRow;  ///< of the pixels, in the picture that they are some rows of
};

/// Whether a picture of each of so many pools may be kept.
bool keepsPools(const glm::ivec2& size, std::size_t pools);

/// In shaded pixels, about what they take on llvmpipe.
struct NearFieldWork {
  double weighed = 0.0;  ///< pixels
  double evaluated = 0.0;  ///< points that see the lights if they are near
  double between = 0.0;  ///< points of which some do
  double rays = 0.0;  ///< to the lights
  double fromPatches = 0.0;  ///< points times the patches that reflect to them
  constexpr double units() const {
    return weighed + 20.0 * evaluated + 4.0 * between + 20.0 * rays + 0.2 * fromPatches;
  }
};

class NearFieldPass {
 public:
  NearFieldPass();
  /// `frameParams` holds the view's FrameParams.
  GpuTask run(NearFieldBuffer& buffer, const Gbuffer& gbuffer, const EmitterBuffer& seenLights,
              const NearFieldSources& sources, const gpu::Buffer& frameParams, Pacing pacing);
  /// The same for patches, which get what comes from the lights; `shadows` has no reflections.
  GpuTask run(PatchSet& patches, const EmitterBufferList& emitters, const ShadowCasters& shadows, Pacing pacing);
  /// The same for what reflections have met.
  GpuTask lookFromMet(const MetPlaces& places, const EmitterBufferList& emitters, const ShadowCasters& shadows,
                      Pacing pacing);
  /// The same for samples apart, some blocks of pixels at a time; after run() for the same picture, whose lists it
  /// takes.
  GpuTask lookFromApart(NearFieldBuffer& buffer, const ApartPlaces& places, const EmitterBufferList& emitters,
                        const ShadowCasters& shadows, Pacing pacing);
  /// What pieces get from the lights; where `shadows` has the patches, and turns of rays to the pieces, of what is
  /// reflected.
  GpuTask lookFromPieces(PatchSet& patches, const EmitterBufferList& emitters, const ShadowCasters& shadows,
                         Pacing pacing);

 private:
  struct Inputs;
  struct Pass;
  struct Look;
  struct LookAt;
  struct LookStep;
  GpuTask lookFrom(PatchSet& patches, const PatchList& list, const EmitterBufferList& emitters,
                   const ShadowCasters& shadows, Pacing pacing);
  static layout::ShadowParams reflectedParams(const Look& from, layout::ShadowParams params);
  std::vector<LookStep> stepsOf(const Look& from, const LookAt& at);
  GpuTask run(const Inputs& inputs, const Pass& pass, Pacing pacing);
  GpuTask runPasses(const Inputs& inputs, Pacing pacing);
  GpuTask runPools(const Inputs& inputs, Pacing pacing);
  GpuTask runFiltered(const Inputs& inputs, Pacing pacing);
  GpuTask filter(const Inputs& inputs, Pacing pacing);
  GpuTask fill(const Inputs& inputs);
  GpuTask smooth(const Inputs& inputs, const Pass& pass);
  GpuTask runSmoothed(const Inputs& inputs, const Pass& pass, Pacing pacing);
  GpuTask look(const Look& from, Pacing pacing);
  GpuTask look(const Look& from, const LookAt& at, Pacing pacing);

  struct Variant {
    int pass = 0;  ///< LPV_PASS_..
    bool everywhere = false;
    bool pool = false;
    bool operator==(const Variant&) const = default;
    gpu::Defines defines() const {
      return {gpu::define("LPV_PASS", pass), gpu::define("LPV_EVERYWHERE", everywhere), gpu::define("LPV_POOL", pool)};
    }
  };
  /// What is on a list of receivers (shaders/visibility/receivers.glsl).
  enum class Receivers { kPixels, kPatches, kMet, kApart };
  struct ReceiverVariant {
    Receivers receivers = Receivers::kPixels;
    bool operator==(const ReceiverVariant&) const = default;
    gpu::Defines defines() const {
      return {gpu::define("LPV_PATCHES", receivers == Receivers::kPatches),
              gpu::define("LPV_MET", receivers == Receivers::kMet),
              gpu::define("LPV_APART", receivers == Receivers::kApart)};
    }
  };
  struct EvaluateVariant {
    bool shadowed = false;
    ReceiverVariant receivers;
    bool operator==(const EvaluateVariant&) const = default;
    gpu::Defines defines() const { return with(receivers, gpu::define("LPV_SHADOWED", shadowed)); }
  };
  struct RayVariant {
    ReceiverVariant receivers;
    bool transparent = false;
    bool operator==(const RayVariant&) const = default;
    gpu::Defines defines() const { return with(receivers, gpu::define("LPV_TRANSPARENT", transparent)); }
  };
  struct ToPoolVariant {
    RayVariant rays;
    bool patches = false;  ///< the pool has the patches, not lights
    bool operator==(const ToPoolVariant&) const = default;
    gpu::Defines defines() const { return with(rays, gpu::define("LPV_FROM_PATCHES", patches)); }
  };
  template <typename Variant>
  static gpu::Defines with(const Variant& variant, gpu::Defines::value_type more) {
    gpu::Defines out = variant.defines();
    out.insert(out.end(), std::move(more));
    return out;
  }
  struct FilterVariant {
    bool reflected = false;
    bool operator==(const FilterVariant&) const = default;
    gpu::Defines defines() const { return {gpu::define("LPV_REFLECTED", reflected)}; }
  };
  gpu::Programs<Variant> choose_{{"frame/near_field.comp"}};
  gpu::Programs<EvaluateVariant> evaluate_{{"frame/near_field_evaluate.comp"}};
  gpu::Programs<RayVariant> reflected_{{"frame/patch_light.comp"}};
  gpu::Programs<ToPoolVariant> rays_{{"frame/shadow_rays.comp"}};
  gpu::Programs<RayVariant> folds_{{"frame/fold_rays.comp"}};
  gpu::Programs<ReceiverVariant> sum_{{"frame/shadow_sum.comp"}};
  gpu::Programs<FilterVariant> filter_{{"frame/near_field_filter.comp"}};
  gpu::ProgramVariants fill_{{"frame/near_field_fill.comp"}};
  gpu::ProgramVariants smooth_{{"frame/near_field_smooth.comp"}};
  gpu::ProgramVariants addPool_{{"frame/near_field_sum.comp"}};
  gpu::ProgramVariants listApart_{{"frame/apart_list.comp"}};
  gpu::Buffer params_, shadowParams_;
};

}  // namespace lpv
