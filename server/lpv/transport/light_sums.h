#pragma once
// In which order the light of many lights is summed, and sums that are kept of it.
//
// Halves of halves, in the order of names. So when one light of many moves, its own light and the sums of the halves
// that it is not in are all that is needed; and since the order follows from the scene alone, the bytes are those of
// summing all anew, whatever was kept.

#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "gpu/buffer.h"
#include "lpv/cached.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/light_voxels.h"
#include "lpv/resources/lights.h"
#include "lpv/resources/palette.h"
#include "lpv/transport/receiver_blocks.h"
#include "lpv/transport/sectors.h"

namespace lpv {

/// Some of the lights, by their numbers: [begin, end).
struct LightRange {
  std::size_t begin = 0, end = 0;

  std::size_t count() const { return end - begin; }
  bool operator==(const LightRange&) const = default;
};

/// What lights send to cells, summed: as LightField::transported() and LightField::emitterDistance hold it.
struct LightSum {
  gpu::Buffer field;
  gpu::Buffer emitterDistance;
};

/// What one light sends is made from.
struct SentInputs {
  Emission light;
  Stamp voxels = 0;
  glm::dvec3 weight{0.0};  ///< of Palette
  int group = 0, nextGroup = 0;
  double moved = 0.0, lookedAt = 0.0;

  bool operator==(const SentInputs&) const = default;
};

/// What all of it is made from besides.
struct ReceivedInputs {
  Stamp memory = 0;  ///< of the field
  double openingRatio = 0.0;
  Sectors sectors = Sectors::kNone;
  int turns = 0;  ///< of shadow rays
  Stamp blockers = 0;
  ReceiverBlocks blocks;

  bool operator==(const ReceivedInputs&) const = default;
};

std::vector<SentInputs> sentInputs(const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels,
                                   const Palette& palette);

/// Of one session. Lights that have not changed for a while stand still; while others change, the largest ranges of
/// such are kept.
class LightSums {
 public:
  /// Before all is summed. What is kept stays as far as it is made from the same.
  void begin(ReceivedInputs received, std::vector<SentInputs> lights);
  /// When all is summed. Where nothing has changed for a while, no memory is kept.
  void end();

  /// Whether the sum of these is to be kept.
  bool keeps(const LightRange& range) const;
  /// What is kept of exactly these, or null.
  const LightSum* known(const LightRange& range) const;
  void keep(const LightRange& range, LightSum sum);

  /// Room for a sum, of undefined content, and back.
  LightSum take(const LightField& field);
  void giveBack(LightSum sum) { spare_.push_back(std::move(sum)); }

 private:
  struct Kept {
    LightRange range;
    LightSum sum;
  };
  template <typename Condition>
  void letGoOf(const Condition& condition);

  std::optional<ReceivedInputs> received_;
  std::vector<SentInputs> lights_;
  std::vector<int> standing_;  ///< per light: sums since it changed
  std::vector<Kept> kept_;
  std::vector<LightSum> spare_;
};

/// So many lights are added to one sum, one after the other: few, since when one of them moves all are gathered again,
/// but not so few that adding the sums up takes longer, or that those under way take much memory. By the scene alone.
/// `bytes`: of one sum.
std::size_t lightsAtOnce(std::size_t lights, std::size_t bytes);
/// The two halves of a range of more lights than that; both begin where a sum does.
std::array<LightRange, 2> halvesOf(const LightRange& range, std::size_t atOnce);

}  // namespace lpv
