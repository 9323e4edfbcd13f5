#include "api/parts.h"

#include "api/convert_geometry.h"
#include "session/limits.h"
#include "wire/publish.h"

namespace lpv::api {
namespace {

constexpr std::size_t kCachedEncodings = 16;

std::int64_t payloadBytes(const wire::EncodedVolume& encoded) {
  std::int64_t bytes = 0;
  for (const wire::Part& part : encoded.parts) bytes += std::int64_t(part.payload.size());
  return bytes;
}

}  // namespace

EncodedVolumePtr VolumeEncodings::get(const VolumePtr& volume, wire::Format format) {
  const std::lock_guard lock(mutex_);  // held while encoding: a second reader waits instead of encoding again
  for (const Entry& entry : entries_) {
    if (entry.format == format && entry.volume.lock() == volume) return entry.encoded;
  }
  auto encoded = std::make_shared<const wire::EncodedVolume>(wire::encodeVolume(
      *wire::publish(*volume, format, 0, nullptr), nullptr, wire::Compression::kNone, kMaxPartBytes));
  std::erase_if(entries_, [](const Entry& entry) { return entry.volume.expired(); });
  entries_.push_front({volume, format, encoded});
  if (entries_.size() > kCachedEncodings) entries_.pop_back();
  return encoded;
}

VolumeEncodings& volumeEncodings() {
  static VolumeEncodings encodings;
  return encodings;
}

VolumeParts::VolumeParts(const Result& result, VolumeStage stage, wire::Format format)
    : result_(result),
      stage_(stage),
      format_(format),
      encoded_(volumeEncodings().get(result.volume, format)),
      bytes_(payloadBytes(*encoded_)) {}

bool VolumeParts::next(pb::VolumePart* out) {
  if (index_ == encoded_->parts.size()) return false;
  if (index_ == 0) {
    pb::VolumeHeader* header = out->mutable_header();
    toProto(result_.meta, header->mutable_result());
    header->mutable_result()->set_checksum(encoded_->checksum);
    toProto(result_.volume->grid, header->mutable_grid());
    header->set_stage(stage_ == VolumeStage::kInjected ? pb::VOLUME_STAGE_INJECTED : pb::VOLUME_STAGE_TRANSPORTED);
    header->set_sh_bands(2);
    header->set_format(toProto(format_));
    header->set_compression(pb::PAYLOAD_COMPRESSION_NONE);
    for (std::size_t i = 0; i < encoded_->scales.size(); ++i) {
      pb::VolumeLayer* layer = header->add_layers();
      layer->set_group(result_.volume->layers[i].group);
      layer->set_scale(encoded_->scales[i]);
    }
    header->set_brick_edge(8);
    header->set_part_count(int(encoded_->parts.size()));
  }
  const wire::Part& part = encoded_->parts[index_];
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

FrameParts::FrameParts(const Result& result, pb::FrameFormat format, std::string file)
    : result_(result), format_(format), file_(std::move(file)) {}

bool FrameParts::next(pb::FramePart* out) {
  if (done_) return false;
  if (index_ == 0) {
    pb::FrameHeader* header = out->mutable_header();
    toProto(result_.meta, header->mutable_result());
    header->mutable_result()->set_checksum(wire::checksumBytes(file_.data(), file_.size()));
    header->set_width(result_.frame->size.x);
    header->set_height(result_.frame->size.y);
    header->set_format(format_);
    header->set_exposure_ev(result_.frame->exposureEv);
    header->set_camera_sequence(result_.cameraSequence);
    header->set_size(std::int64_t(file_.size()));
    header->set_part_count(int((file_.size() + kMaxPartBytes - 1) / kMaxPartBytes));
  }
  const std::size_t count = std::min(kMaxPartBytes, file_.size() - offset_);
  out->set_result_id(result_.meta.resultId);
  out->set_index(index_++);
  out->set_payload(file_.data() + offset_, count);
  offset_ += count;
  done_ = offset_ == file_.size();
  return true;
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
    stage->set_stage(time.stage);
    stage->set_seconds(time.seconds);
  }
  for (const std::string& feature : report.features) out->add_features(feature);
  out->set_triangles_skipped(report.trianglesSkipped);
  out->set_touched_cells(report.touchedCells);
  out->set_clamped_cells(report.clampedCells);
}

Expected<wire::Format> volumeFormatOf(pb::VolumeFormat format) {
  switch (format) {
    case pb::VOLUME_FORMAT_UNSPECIFIED:
    case pb::VOLUME_FORMAT_HALF_FLOAT:
      return wire::Format::kHalf;
    case pb::VOLUME_FORMAT_FLOAT:
      return wire::Format::kFloat;
    case pb::VOLUME_FORMAT_COMPACT:
      return unimplemented("format", "format COMPACT is not built in this version; use HALF_FLOAT or FLOAT");
    default:
      return invalid("format", "format has the unknown value " + std::to_string(int(format)));
  }
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

Expected<VolumeStage> stageOf(pb::VolumeStage stage) {
  switch (stage) {
    case pb::VOLUME_STAGE_UNSPECIFIED:
    case pb::VOLUME_STAGE_TRANSPORTED:
      return VolumeStage::kTransported;
    case pb::VOLUME_STAGE_INJECTED:
      return VolumeStage::kInjected;
    default:
      return invalid("stage", "stage has the unknown value " + std::to_string(int(stage)));
  }
}

}  // namespace lpv::api
