#include "assemble.h"

#include <utility>

#include "lpv/convert.h"

namespace lpv::client {
namespace {

/// Upper bound of an encoded frame of 4096 x 4096 float pixels, bytes.
constexpr std::int64_t kMaxFrameBytes = std::int64_t(512) << 20;

/// Volumes kept: the base of two results in flight, and those two.
constexpr std::size_t kMostHeld = 3;

Status broken(const std::string& what) { return Status(Code::kInternal, "the server sent " + what); }

Expected<wire::Format> formatOf(const v1::VolumeHeader& header) {
  if (header.coefficients() != int(wire::kCellElements) / 3) {
    return broken("a volume of " + std::to_string(header.coefficients()) +
                  " coefficients per colour; this client reads 4");
  }
  if (header.guard_cells() != 0 && header.guard_cells() != kGuardCells) {
    return broken("a volume with " + std::to_string(header.guard_cells()) + " guard cells; this client reads 0 and 1");
  }
  for (const v1::VolumeLayer& layer : header.layers()) {
    if (layer.has_grid() && fromProto(layer.grid()) != fromProto(header.grid())) {
      return broken("a volume of several grids; this client reads one");
    }
  }
  if (header.brick_edge() != wire::kBrickEdge) return broken("bricks of another size than 8");
  switch (header.format()) {
    case v1::VOLUME_FORMAT_UNSPECIFIED:
    case v1::VOLUME_FORMAT_HALF_FLOAT:
      return wire::Format::kHalf;
    case v1::VOLUME_FORMAT_FLOAT:
      return wire::Format::kFloat;
    case v1::VOLUME_FORMAT_COMPACT:
      return wire::Format::kCompact;
    default:
      return broken("a volume format this client does not know");
  }
}

Expected<wire::Compression> compressionOf(const v1::VolumeHeader& header) {
  switch (header.compression()) {
    case v1::PAYLOAD_COMPRESSION_UNSPECIFIED:
    case v1::PAYLOAD_COMPRESSION_NONE:
      return wire::Compression::kNone;
    case v1::PAYLOAD_COMPRESSION_ZSTD:
      return wire::Compression::kZstd;
    default:
      return broken("a compression this client does not know");
  }
}

wire::VolumeShape shapeOf(const v1::VolumeHeader& header, wire::Format format) {
  wire::VolumeShape shape;
  shape.format = format;
  shape.grid = fromProto(header.grid());
  if (header.guard_cells() > 0) shape.grid = guardedGrid(shape.grid);
  shape.stage = header.stage() == v1::VOLUME_STAGE_INJECTED ? VolumeStage::kInjected : VolumeStage::kTransported;
  for (const v1::VolumeLayer& layer : header.layers()) {
    shape.groups.push_back(layer.group());
    shape.scales.push_back(format == wire::Format::kFloat ? 1.0 : layer.scale());
  }
  return shape;
}

/// Checks that the parts of one result have the indices 0, 1, 2 ... in order.
Status checkPart(int index, int next, std::uint64_t id, std::uint64_t wanted, int count) {
  if (index != next || index >= count)
    return broken("part " + std::to_string(index) + ", expected " + std::to_string(next));
  if (id != wanted)
    return broken("a part of result " + std::to_string(id) + " between parts of result " + std::to_string(wanted));
  return {};
}

}  // namespace

Status VolumeAssembler::begin(const v1::VolumePart& part) {
  const v1::VolumeHeader& header = part.header();
  const Expected<wire::Format> format = formatOf(header);
  if (!format) return format.status();
  const Expected<wire::Compression> compression = compressionOf(header);
  if (!compression) return compression.status();
  const std::uint64_t baseId = header.base_result_id();
  const auto base = held_.find(baseId);
  if (baseId != 0 && base == held_.end()) {
    return broken("a volume relative to result " + std::to_string(baseId) + ", which this client does not hold");
  }
  decoder_ = std::make_unique<wire::VolumeDecoder>(shapeOf(header, *format), *compression,
                                                   baseId == 0 ? nullptr : base->second);
  result_ = {};
  result_.header = header;
  next_ = 0;
  began_ = std::chrono::steady_clock::now();
  return {};
}

Expected<std::optional<VolumeResult>> VolumeAssembler::add(const v1::VolumePart& part) {
  if (part.has_header()) {
    if (Status status = begin(part); !status.ok()) {
      decoder_.reset();
      return status;
    }
  }
  if (!decoder_) return std::optional<VolumeResult>();  // a later part of a result that was abandoned
  Status status = checkPart(part.index(), next_, part.result_id(), result_.header.result().result_id(),
                            result_.header.part_count());
  std::vector<wire::BrickRun> bricks;
  for (const v1::BrickRun& run : part.bricks()) bricks.push_back({run.first(), run.count()});
  if (status.ok()) status = decoder_->add(bricks, part.payload());
  if (!status.ok()) {
    decoder_.reset();
    return status;
  }
  result_.bytes += part.payload().size();
  if (++next_ < result_.header.part_count()) return std::optional<VolumeResult>();
  Expected<VolumeResult> result = finish();
  if (!result) return result.status();
  return std::optional<VolumeResult>(std::move(*result));
}

Expected<VolumeResult> VolumeAssembler::finish() {
  Expected<wire::VolumeStatePtr> state = decoder_->finish(result_.header.result().checksum());
  decoder_.reset();
  if (!state) return state.status();
  result_.volume = wire::volumeFrom(**state);
  hold(std::move(*state));
  result_.decodeSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  return std::move(result_);
}

/// Drops bases older than the newest result's: bases only move forward.
void VolumeAssembler::hold(wire::VolumeStatePtr state) {
  held_.erase(held_.begin(), held_.lower_bound(result_.header.base_result_id()));
  held_[result_.header.result().result_id()] = std::move(state);
  while (held_.size() > kMostHeld) held_.erase(held_.begin());
}

Status FrameAssembler::begin(const v1::FramePart& part) {
  result_ = {};
  result_.header = part.header();
  next_ = 0;
  active_ = part.header().size() >= 0 && part.header().size() <= kMaxFrameBytes;
  return active_ ? Status() : broken("a frame of " + std::to_string(part.header().size()) + " bytes");
}

Expected<std::optional<FrameResult>> FrameAssembler::add(const v1::FramePart& part) {
  if (part.has_header()) {
    if (Status status = begin(part); !status.ok()) return status;
  }
  if (!active_) return std::optional<FrameResult>();
  const v1::FrameHeader& header = result_.header;
  Status status = checkPart(part.index(), next_, part.result_id(), header.result().result_id(), header.part_count());
  if (status.ok() && std::int64_t(result_.file.size() + part.payload().size()) > header.size()) {
    status = broken("more bytes of a frame than its header announced");
  }
  if (!status.ok()) {
    active_ = false;
    return status;
  }
  result_.file += part.payload();
  if (++next_ < header.part_count()) return std::optional<FrameResult>();
  active_ = false;
  if (std::int64_t(result_.file.size()) != header.size())
    return broken("fewer bytes of a frame than its header announced");
  if (wire::checksumBytes(result_.file.data(), result_.file.size()) != header.result().checksum()) {
    return broken("a frame with a wrong checksum");
  }
  return std::optional<FrameResult>(std::move(result_));
}

}  // namespace lpv::client
