#include <algorithm>

#include "wire/brick_transform.h"
#include "wire/byte_planes.h"
#include "wire/compression.h"
#include "wire/run_level.h"
#include "wire/volume_codec.h"

namespace lpv::wire {
namespace {

/// Collects bricks until a part is full, then packs them.
class PartWriter {
 public:
  PartWriter(const VolumeState& target, const VolumeState* base, Compression compression, std::size_t maxPayloadBytes)
      : target_(target), base_(base), compression_(compression) {
    // zstd enlarges incompressible data by a little.
    limit_ = compression == Compression::kZstd ? maxPayloadBytes - maxPayloadBytes / 128 - 64 : maxPayloadBytes;
  }

  void add(int index) {
    const auto i = std::size_t(index);
    RunLevels runLevels;
    std::size_t bytes = target_.bricks[i]->elements.size();
    if (target_.shape.format == Format::kCompact) {
      if (!appendRunLevels(i, &runLevels) && base_ != nullptr) return;
      bytes = runLevels.bytes();
    }
    if (!bricks_.empty() && size_ + bytes > limit_) flush();
    if (bricks_.empty()) size_ = sizeof(std::uint32_t);
    bricks_.push_back(index);
    size_ += bytes;
    runLevels_.runs += runLevels.runs;
    runLevels_.levels += runLevels.levels;
  }

  std::vector<Part> finish() {
    if (!bricks_.empty() || parts_.empty()) flush();
    return std::move(parts_);
  }

 private:
  /// Returns false if the brick equals its base.
  bool appendRunLevels(std::size_t i, RunLevels* runLevels) const {
    const Brick* base = base_ != nullptr ? base_->bricks[i].get() : nullptr;
    std::vector<std::int32_t> coefficients = target_.bricks[i]->coefficients;
    if (base != nullptr) {
      std::transform(coefficients.begin(), coefficients.end(), base->coefficients.begin(), coefficients.begin(),
                     std::minus<>());
    }
    bool any = false;
    for (std::size_t at = 0; at < coefficients.size(); at += kChannels * kBrickCells) {
      any |= appendBlock(coefficients.data() + at, runLevels);
    }
    return any;
  }

  std::string body() const {
    std::string out;
    if (target_.shape.format == Format::kCompact) {
      const auto runs = std::uint32_t(runLevels_.runs.size());
      out.append(reinterpret_cast<const char*>(&runs), sizeof(runs));
      return out + runLevels_.runs + runLevels_.levels;
    }
    if (compression_ == Compression::kZstd) return planesFrom(target_.shape, planeBricks());
    for (const int i : bricks_) out += target_.bricks[std::size_t(i)]->elements;
    return out;
  }

  std::vector<PlaneBrick> planeBricks() const {
    std::vector<PlaneBrick> out;
    for (const int index : bricks_) {
      const auto i = std::size_t(index);
      out.push_back({brickBox(target_.shape.grid.dims, index).size(),
                     base_ != nullptr ? base_->bricks[i].get() : nullptr, &target_.bricks[i]->elements, nullptr});
    }
    return out;
  }

  void flush() {
    Part& part = parts_.emplace_back();
    for (const int brick : bricks_) {
      const bool next = !part.bricks.empty() && part.bricks.back().first + part.bricks.back().count == brick;
      if (next) ++part.bricks.back().count;
      if (!next) part.bricks.push_back({brick, 1});
    }
    if (!bricks_.empty()) part.payload = compression_ == Compression::kZstd ? compress(body()) : body();
    bricks_.clear();
    runLevels_ = {};
  }

  const VolumeState& target_;
  const VolumeState* base_;
  Compression compression_;
  std::size_t limit_ = 0;
  std::vector<int> bricks_;  ///< bricks of the part being written
  std::size_t size_ = 0;     ///< size of that part before compression, bytes
  RunLevels runLevels_;
  std::vector<Part> parts_;
};

}  // namespace

EncodedVolume encodeVolume(const VolumeState& target, const VolumeState* base, Compression compression,
                           std::size_t maxPayloadBytes) {
  PartWriter writer(target, base, compression, maxPayloadBytes);
  for (std::size_t i = 0; i < target.bricks.size(); ++i) {
    if (!target.bricks[i]) continue;
    const bool same = base != nullptr && (base->bricks[i] == target.bricks[i] ||
                                          (base->bricks[i] && base->bricks[i]->elements == target.bricks[i]->elements &&
                                           base->bricks[i]->coefficients == target.bricks[i]->coefficients));
    if (!same) writer.add(int(i));
  }
  return {checksumOf(target), target.shape.scales, compression, writer.finish()};
}

}  // namespace lpv::wire
