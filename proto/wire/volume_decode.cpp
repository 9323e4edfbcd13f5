#include <cstring>
#include <utility>

#include "wire/brick_transform.h"
#include "wire/byte_planes.h"
#include "wire/compression.h"
#include "wire/run_level.h"
#include "wire/volume_codec.h"

namespace lpv::wire {

VolumeDecoder::VolumeDecoder(VolumeShape shape, Compression compression, VolumeStatePtr base)
    : base_(std::move(base)), compression_(compression) {
  status_ = checkShape(shape);
  if (status_.ok() && base_ && base_->shape != shape) {
    status_ = invalid("base_result_id", "the base has another grid, stage, format, layers or scale than the volume");
  }
  state_.shape = std::move(shape);
  if (!status_.ok()) return;
  const auto bricks = std::size_t(brickCount(state_.shape.grid.dims));
  seen_.assign(bricks, false);
  state_.bricks.resize(bricks);
  if (base_) state_.bricks = base_->bricks;
}

/// Expands the runs to brick numbers and marks them as seen.
Expected<std::vector<int>> VolumeDecoder::claim(const std::vector<BrickRun>& runs) {
  const int total = int(seen_.size());
  std::vector<int> out;
  for (const BrickRun& run : runs) {
    if (run.first < 0 || run.count < 1 || run.first >= total || run.count > total - run.first) {
      return invalid("part.bricks", "bricks " + std::to_string(run.first) + " + " + std::to_string(run.count) +
                                        " are outside the volume's " + std::to_string(total));
    }
    for (int brick = run.first; brick < run.first + run.count; ++brick) {
      if (seen_[std::size_t(brick)]) return invalid("part.bricks", "brick " + std::to_string(brick) + " comes twice");
      seen_[std::size_t(brick)] = true;
      out.push_back(brick);
    }
  }
  return out;
}

std::size_t VolumeDecoder::plainBytes(const std::vector<int>& bricks) const {
  std::size_t cells = 0;
  for (const int brick : bricks) cells += brickBox(state_.shape.grid.dims, brick).cells();
  return cells * state_.shape.layers() * kCellElements * elementBytes(state_.shape.format);
}

Status VolumeDecoder::add(const std::vector<BrickRun>& runs, const std::string& payload) {
  if (status_.ok()) status_ = addBricks(runs, payload);
  return status_;
}

Status VolumeDecoder::addBricks(const std::vector<BrickRun>& runs, const std::string& payload) {
  const Expected<std::vector<int>> bricks = claim(runs);
  if (!bricks) return bricks.status();
  const bool compact = state_.shape.format == Format::kCompact;
  if (bricks->empty())
    return payload.empty() ? Status() : invalid("part.payload", "the part has a payload and no bricks");
  if (compression_ == Compression::kNone) return compact ? addRunLevels(*bricks, payload) : addPlain(*bricks, payload);
  const Expected<std::string> body = decompress(payload, kMaxPayloadBytes);
  if (!body) return body.status();
  return compact ? addRunLevels(*bricks, *body) : addPlanes(*bricks, *body);
}

static Status wrongSize(std::size_t got, std::size_t wanted) {
  return invalid("part.payload",
                 "the payload has " + std::to_string(got) + " bytes, but its bricks need " + std::to_string(wanted));
}

Status VolumeDecoder::addPlain(const std::vector<int>& bricks, std::string_view body) {
  if (body.size() != plainBytes(bricks)) return wrongSize(body.size(), plainBytes(bricks));
  for (const int index : bricks) {
    auto brick = std::make_shared<Brick>();
    brick->elements = body.substr(0, plainBytes({index}));
    body.remove_prefix(brick->elements.size());
    state_.bricks[std::size_t(index)] = std::move(brick);
  }
  return {};
}

Status VolumeDecoder::addPlanes(const std::vector<int>& bricks, const std::string& body) {
  if (body.size() != plainBytes(bricks)) return wrongSize(body.size(), plainBytes(bricks));
  std::vector<PlaneBrick> planes;
  std::vector<std::shared_ptr<Brick>> made;
  for (const int index : bricks) {
    made.push_back(std::make_shared<Brick>());
    made.back()->elements.resize(plainBytes({index}));
    planes.push_back({brickBox(state_.shape.grid.dims, index).size(), state_.bricks[std::size_t(index)].get(), nullptr,
                      &made.back()->elements});
  }
  elementsFromPlanes(state_.shape, body, planes);
  for (std::size_t i = 0; i < bricks.size(); ++i) state_.bricks[std::size_t(bricks[i])] = std::move(made[i]);
  return {};
}

Status VolumeDecoder::addRunLevels(const std::vector<int>& bricks, std::string_view body) {
  std::uint32_t runs = 0;
  if (body.size() < sizeof(runs)) return wrongSize(body.size(), sizeof(runs));
  std::memcpy(&runs, body.data(), sizeof(runs));
  body.remove_prefix(sizeof(runs));
  if (runs > body.size()) return wrongSize(body.size(), runs);
  RunLevelReader reader(body.substr(0, runs), body.substr(runs));
  const std::size_t layers = state_.shape.layers();
  for (const int index : bricks) {
    BrickPtr& place = state_.bricks[std::size_t(index)];
    auto brick = std::make_shared<Brick>();
    if (place) brick->coefficients = place->coefficients;
    brick->coefficients.resize(layers * kChannels * kBrickCells);
    for (std::size_t layer = 0; layer < layers; ++layer) {
      const Status s = reader.addBlock(brick->coefficients.data() + layer * kChannels * kBrickCells);
      if (!s.ok()) return s;
    }
    setCompactElements(brickBox(state_.shape.grid.dims, index).size(), layers, brick.get());
    place = std::move(brick);
  }
  return reader.atEnd() ? Status() : invalid("part.payload", "the payload has bytes left over after its bricks");
}

Expected<VolumeStatePtr> VolumeDecoder::finish(std::uint64_t checksum) {
  if (!status_.ok()) return status_;
  if (checksumOf(state_) != checksum) {
    return invalid("result.checksum", "the volume's bricks do not give the checksum sent with it");
  }
  status_ = Status(Code::kFailedPrecondition, "the volume has already been returned");
  base_.reset();
  return VolumeStatePtr(std::make_shared<const VolumeState>(std::move(state_)));
}

}  // namespace lpv::wire
