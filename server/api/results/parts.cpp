#include "api/results/parts.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "convert/geometry.h"
#include "encode/false_colour.h"
#include "engine/stage.h"
#include "wire/message_size.h"
#include "wire/publish.h"

namespace lpv::api {
namespace {

constexpr std::size_t kCachedEncodings = 16;
/// Volumes up to this size are kept when no answer holds them any more, and take no room.
constexpr std::int64_t kSmallEncoding = 1024 * 1024;

std::int64_t payloadBytes(const wire::EncodedVolume& encoded) {
  std::int64_t bytes = 0;
  for (const wire::Part& part : encoded.parts) bytes += std::int64_t(part.payload.size());
  return bytes;
}

/// While it is encoded: the quantized volume, and what that is written to.
std::int64_t encodingBytes(const Volume& volume, wire::Format format) {
  const std::int64_t bytesPerElement = format == wire::Format::kHalf ? 2 : 4;
  return 2 * bytesPerElement * std::int64_t(volume.grid.cells() * wire::kCellElements * volume.layers.size());
}

/// The result without its volume's cells.
Result withoutCells(const Result& result) {
  Result out = result;
  auto head = std::make_shared<Volume>();
  head->grid = result.volume->grid;
  for (const VolumeLayer& layer : result.volume->layers) head->layers.push_back({layer.group, {}});
  out.volume = std::move(head);
  return out;
}

/// The result without its frame's pixels.
Result withoutPixels(const Result& result) {
  Result out = result;
  const Frame& frame = *result.frame;
  out.frame = std::make_shared<const Frame>(Frame{frame.size, frame.format, {}, {}, frame.exposureEv, frame.camera});
  return out;
}

}  // namespace

Expected<EncodingPtr> VolumeEncodings::get(const VolumePtr& volume, const VolumeEncodingRequest& order,
                                           const EncodingRoom& room, Counters& counters) {
  const MutexLock lock(mutex_);  // held while encoding: a second caller waits instead of encoding again
  for (const Entry& entry : entries_) {
    const bool coding = entry.format == order.format && entry.compression == order.compression;
    const EncodingPtr made = coding && entry.volume.lock() == volume ? entry.encoding.lock() : nullptr;
    if (made) return made;
  }
  auto encoding = std::make_shared<Encoding>();
  if (const std::int64_t most = encodingBytes(*volume, order.format); most > kSmallEncoding) {
    Expected<AnswerHoldPtr> hold = room.answers.take(room.session, most, room.limits);
    if (!hold) return hold.status();
    encoding->hold = std::move(*hold);
  }
  ++counters.volumesEncoded;
  encoding->volume = wire::encodeVolume(*wire::publish(*volume, order.format, 0, nullptr), nullptr, order.compression,
                                        wire::kMaxPartBytes);
  const std::int64_t bytes = payloadBytes(encoding->volume);
  const bool small = bytes <= kSmallEncoding;
  if (small) encoding->hold = nullptr;
  if (encoding->hold) encoding->hold->shrinkTo(bytes);
  std::erase_if(entries_, [](const Entry& entry) { return entry.volume.expired() || entry.encoding.expired(); });
  entries_.push_front({volume, order.format, order.compression, encoding, small ? encoding : nullptr});
  if (entries_.size() > kCachedEncodings) entries_.pop_back();
  return EncodingPtr(encoding);
}

VolumeParts::VolumeParts(const Result& result, const VolumeEncodingRequest& order, EncodingPtr encoding)
    : result_(withoutCells(result)),
      order_(order),
      encoding_(std::move(encoding)),
      bytes_(payloadBytes(encoding_->volume)) {}

void VolumeParts::fill(pb::VolumeHeader* header) const {
  const wire::EncodedVolume& volume = encoding_->volume;
  toProto(result_.meta, header->mutable_result());
  header->mutable_result()->set_checksum(volume.checksum);
  toProto(result_.volume->grid, header->mutable_grid());
  header->set_stage(order_.stage == VolumeStage::kInjected ? pb::VOLUME_STAGE_INJECTED : pb::VOLUME_STAGE_TRANSPORTED);
  header->set_coefficients(int(wire::kCellElements) / 3);
  header->set_format(toProto(order_.format));
  header->set_compression(toProto(order_.compression));
  for (std::size_t i = 0; i < volume.scales.size(); ++i) {
    pb::VolumeLayer* layer = header->add_layers();
    layer->set_group(result_.volume->layers[i].group);
    layer->set_scale(volume.scales[i]);
    layer->set_kind(pb::LAYER_KIND_DIRECT);
  }
  header->set_base_result_id(encoding_->baseId);
  header->set_brick_edge(wire::kBrickEdge);
  header->set_part_count(int(volume.parts.size()));
  header->set_guard_cells(order_.guarded ? kGuardCells : 0);
}

bool VolumeParts::next(pb::VolumePart* out) {
  if (index_ == encoding_->volume.parts.size()) return false;
  if (index_ == 0) fill(out->mutable_header());
  const wire::Part& part = encoding_->volume.parts[index_];
  out->set_result_id(result_.meta.resultId);
  out->set_index(int(index_));
  for (const wire::BrickRun& run : part.bricks) {
    pb::BrickRun* bricks = out->add_bricks();
    bricks->set_first(run.first);
    bricks->set_count(run.count);
  }
  out->set_payload(part.payload);
  ++index_;
  return true;
}

/// Linear pixels that are not for EXR are irradiance, for people.
Expected<std::string> encodeFrame(const Frame& frame, pb::FrameFormat format, int quality) {
  if (format == pb::FRAME_FORMAT_EXR) return encode::exr(frame.size, frame.rgb32f);
  const bool linear = frame.format == PixelFormat::kRgb32F;
  const std::vector<std::uint8_t> colours =
      linear ? encode::falseColours(frame.size, frame.rgb32f) : std::vector<std::uint8_t>();
  const std::vector<std::uint8_t>& rgb = linear ? colours : frame.rgb8;
  return format == pb::FRAME_FORMAT_PNG ? encode::png(frame.size, rgb) : encode::jpeg(frame.size, rgb, quality);
}

std::optional<std::shared_future<Expected<FrameFile>>> FrameEncodings::find(const FramePtr& frame,
                                                                            pb::FrameFormat format, int quality) const {
  for (const Entry& entry : entries_) {
    if (entry.frame.lock() == frame && entry.format == format && entry.quality == quality) return entry.file;
  }
  return std::nullopt;
}

Expected<FrameFile> FrameEncodings::get(const FramePtr& frame, pb::FrameFormat format, int quality, WorkerPool& pool) {
  std::promise<Expected<FrameFile>> made;
  std::optional<std::shared_future<Expected<FrameFile>>> others;
  {
    const MutexLock lock(mutex_);
    others = find(frame, format, quality);
    if (!others) {
      std::erase_if(entries_, [](const Entry& entry) { return entry.frame.expired(); });
      entries_.push_back({frame, format, quality, made.get_future().share()});
    }
  }
  if (others) {
    pool.blockingSection([&] { others->wait(); });
    return others->get();
  }
  Expected<std::string> file = encodeFrame(*frame, format, quality);
  const Expected<FrameFile> out =
      file ? Expected<FrameFile>(std::make_shared<const std::string>(std::move(*file))) : file.status();
  made.set_value(out);
  return out;
}

FrameParts::FrameParts(Result result, pb::FrameFormat format, FrameFile file)
    : result_(withoutPixels(result)), format_(format), file_(std::move(file)) {
  result.frame = nullptr;
  if (result_.hold) result_.hold->shrinkTo(bytes());
}

bool FrameParts::next(pb::FramePart* out) {
  if (done_) return false;
  if (index_ == 0) {
    pb::FrameHeader* header = out->mutable_header();
    toProto(result_.meta, header->mutable_result());
    header->mutable_result()->set_checksum(wire::checksumBytes(file_->data(), file_->size()));
    header->set_width(result_.frame->size.x);
    header->set_height(result_.frame->size.y);
    header->set_format(format_);
    if (format_ == pb::FRAME_FORMAT_JPEG) header->set_quality(result_.quality);
    header->set_exposure_ev(result_.frame->exposureEv);
    header->set_camera_sequence(result_.cameraSequence);
    header->set_sharp(result_.sharp);
    toProto("", result_.frame->camera, header->mutable_camera());
    header->set_size(bytes());
    header->set_part_count(int((file_->size() + wire::kMaxPartBytes - 1) / wire::kMaxPartBytes));
  }
  const std::size_t count = std::min(wire::kMaxPartBytes, file_->size() - offset_);
  out->set_result_id(result_.meta.resultId);
  out->set_index(index_++);
  out->set_payload(file_->data() + offset_, count);
  offset_ += count;
  done_ = offset_ == file_->size();
  return true;
}

/// By name: a stage that the protocol does not know yet is UNSPECIFIED.
pb::TickStage toProto(Stage stage) {
  static const std::array<pb::TickStage, kStages> all = [] {
    std::array<pb::TickStage, kStages> out{};
    for (const StageRow& row : kStageTable) {
      std::string name = std::string("TICK_STAGE_") + row.name;
      std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return char(std::toupper(c)); });
      if (!pb::TickStage_Parse(name, &out[std::size_t(row.stage)]))
        out[std::size_t(row.stage)] = pb::TICK_STAGE_UNSPECIFIED;
    }
    return out;
  }();
  return all[std::size_t(stage)];
}

void toProto(const ResultMeta& meta, pb::ResultInfo* out) {
  out->set_epoch(meta.epoch);
  out->set_revision(meta.revision);
  out->set_result_id(meta.resultId);
  out->set_server_time_ns(meta.completedNs);
  out->set_client_sequence(meta.clientSequence);
  const TickReport& report = *meta.report;
  for (const StageTime& time : report.stages) {
    pb::StageTime* stage = out->add_stage_times();
    stage->set_stage(toProto(time.stage));
    stage->set_seconds(time.seconds);
  }
  for (const std::string& feature : report.features) out->add_features(feature);
  out->set_triangles_skipped(report.trianglesSkipped);
  out->set_touched_cells(report.touchedCells);
  out->set_clamped_cells(report.clampedCells);
}

pb::VolumeFormat toProto(wire::Format format) {
  switch (format) {
    case wire::Format::kHalf:
      return pb::VOLUME_FORMAT_HALF_FLOAT;
    case wire::Format::kFloat:
      return pb::VOLUME_FORMAT_FLOAT;
    case wire::Format::kCompact:
      return pb::VOLUME_FORMAT_COMPACT;
  }
  return pb::VOLUME_FORMAT_UNSPECIFIED;
}

SentAs sentAs(wire::Format format) {
  switch (format) {
    case wire::Format::kHalf:
      return SentAs::kVolumeHalf;
    case wire::Format::kFloat:
      return SentAs::kVolumeFloat;
    case wire::Format::kCompact:
      break;
  }
  return SentAs::kVolumeCompact;
}

SentAs sentAs(pb::FrameFormat format) {
  if (format == pb::FRAME_FORMAT_PNG) return SentAs::kFramePng;
  return format == pb::FRAME_FORMAT_EXR ? SentAs::kFrameExr : SentAs::kFrameJpeg;
}

pb::PayloadCompression toProto(wire::Compression compression) {
  return compression == wire::Compression::kZstd ? pb::PAYLOAD_COMPRESSION_ZSTD : pb::PAYLOAD_COMPRESSION_NONE;
}

}  // namespace lpv::api
