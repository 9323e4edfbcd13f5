#include "api/results/subscription.h"

#include <bit>
#include <cmath>

#include "convert/geometry.h"

namespace lpv::api {
namespace {

constexpr int kDefaultQuality = 85;
constexpr int kMostSamples = 64;

Status checkEdge(const char* field, int edge, const Limits& limits) {
  if (edge >= limits.minFrameEdge && edge <= limits.maxFrameEdge) return {};
  return invalid(field, std::string(field) + " is " + std::to_string(edge) + " pixels, allowed are " +
                            std::to_string(limits.minFrameEdge) + " to " + std::to_string(limits.maxFrameEdge));
}

Expected<pb::FrameFormat> formatOf(pb::FrameFormat format, pb::FrameFormat otherwise) {
  if (format == pb::FRAME_FORMAT_UNSPECIFIED) return otherwise;
  if (pb::FrameFormat_IsValid(int(format))) return format;
  return invalid("format", "format has the unknown value " + std::to_string(int(format)));
}

Expected<int> qualityOf(int quality) {
  if (quality == 0) return kDefaultQuality;
  if (quality >= 1 && quality <= 100) return quality;
  return invalid("quality", "quality is " + std::to_string(quality) + ", allowed are 1 to 100");
}

Expected<int> samplesOf(int samples, int otherwise) {
  if (samples == 0) return otherwise;
  if (samples >= 1 && samples <= kMostSamples && std::has_single_bit(unsigned(samples))) return samples;
  return invalid("samples",
                 "samples is " + std::to_string(samples) + ", allowed are 1, 2, 4, 8, 16, 32 and 64 of each pixel");
}

Expected<CameraChoice> cameraChoice(const pb::Camera* camera, const std::string& name) {
  CameraChoice choice;
  choice.name = name;
  if (!camera) return choice;
  if (!name.empty()) return invalid("camera_name", "camera and camera_name are both given; give one");
  const Expected<Camera> checked = fromProto(*camera);
  if (!checked) return checked.status().within("camera");
  choice.camera = *checked;
  return choice;
}

/// Of what a request leaves open.
struct FrameDefaults {
  pb::FrameFormat format;
  int samples;
};
constexpr FrameDefaults kOfStreams = {pb::FRAME_FORMAT_JPEG, 1};
constexpr FrameDefaults kOfCalls = {pb::FRAME_FORMAT_PNG, 32};

/// What subscriptions and calls have in common.
template <typename Message>
Expected<FrameEncodingRequest> common(const Message& in, const pb::Camera* camera, const FrameDefaults& otherwise,
                                      const Limits& limits) {
  FrameEncodingRequest order;
  const Expected<glm::ivec2> size = frameSize(in.width(), in.height(), limits);
  if (!size) return size.status();
  const Expected<pb::FrameFormat> format = formatOf(in.format(), otherwise.format);
  if (!format) return format.status();
  const Expected<int> quality = qualityOf(in.quality());
  if (!quality) return quality.status();
  const Expected<int> samples = samplesOf(in.samples(), otherwise.samples);
  if (!samples) return samples.status();
  const Expected<lpv::Exposure> exposure = exposureFrom(in.exposure());
  if (!exposure) return exposure.status().within("exposure");
  const Expected<CameraChoice> choice = cameraChoice(camera, in.camera_name());
  if (!choice) return choice.status();
  order.subscription.size = *size;
  order.subscription.exposure = *exposure;
  order.subscription.camera = *choice;
  order.subscription.format = *format == pb::FRAME_FORMAT_EXR ? PixelFormat::kRgb32F : PixelFormat::kRgb8;
  order.format = *format;
  order.subscription.quality = *quality;
  order.subscription.samples = *samples;
  return order;
}

Expected<FrameQuantity> quantityOf(pb::FrameQuantity quantity) {
  switch (quantity) {
    case pb::FRAME_QUANTITY_UNSPECIFIED:
    case pb::FRAME_QUANTITY_RADIANCE:
      return FrameQuantity::kRadiance;
    case pb::FRAME_QUANTITY_IRRADIANCE:
      return FrameQuantity::kIrradiance;
    default:
      return invalid("quantity", "quantity has the unknown value " + std::to_string(int(quantity)));
  }
}

Expected<wire::Format> volumeFormatOf(pb::VolumeFormat format) {
  switch (format) {
    case pb::VOLUME_FORMAT_UNSPECIFIED:
    case pb::VOLUME_FORMAT_HALF_FLOAT:
      return wire::Format::kHalf;
    case pb::VOLUME_FORMAT_FLOAT:
      return wire::Format::kFloat;
    case pb::VOLUME_FORMAT_COMPACT:
      return wire::Format::kCompact;
    default:
      return invalid("format", "format has the unknown value " + std::to_string(int(format)));
  }
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

Expected<wire::Compression> compressionOf(pb::PayloadCompression compression, wire::Compression otherwise) {
  switch (compression) {
    case pb::PAYLOAD_COMPRESSION_UNSPECIFIED:
      return otherwise;
    case pb::PAYLOAD_COMPRESSION_NONE:
      return wire::Compression::kNone;
    case pb::PAYLOAD_COMPRESSION_ZSTD:
      return wire::Compression::kZstd;
    default:
      return invalid("compression", "compression has the unknown value " + std::to_string(int(compression)));
  }
}

Expected<Bounds> regionFrom(const pb::Box& in) {
  const Bounds region = fromProto(in);
  for (int axis = 0; axis < 3; ++axis) {
    const double low = region.min[axis];
    const double high = region.max[axis];
    if (std::isfinite(low) && std::isfinite(high) && low <= high) continue;
    return invalid("region", "region goes from " + std::to_string(low) + " to " + std::to_string(high) +
                                 " along axis " + std::to_string(axis) + "; both have to be finite, min below max");
  }
  return region;
}

/// What subscriptions and calls have in common.
template <typename Message>
Expected<VolumeEncodingRequest> commonVolume(const Message& in, bool stream) {
  VolumeEncodingRequest order;
  const Expected<VolumeStage> stage = stageOf(in.stage());
  if (!stage) return stage.status();
  const Expected<wire::Format> format = volumeFormatOf(in.format());
  if (!format) return format.status();
  const bool zstd = stream || *format == wire::Format::kCompact;
  const auto compression = compressionOf(in.compression(), zstd ? wire::Compression::kZstd : wire::Compression::kNone);
  if (!compression) return compression.status();
  if (in.guard_cells() < 0 || in.guard_cells() > kGuardCells) {
    return invalid("guard_cells", "guard_cells is " + std::to_string(in.guard_cells()) + ", allowed are 0 and " +
                                      std::to_string(kGuardCells) + ", all that a lookup reads");
  }
  order.guarded = in.guard_cells() > 0;
  order.stage = *stage;
  order.format = *format;
  order.compression = *compression;
  return order;
}

}  // namespace

Expected<lpv::Exposure> exposureFrom(const pb::Exposure& in) {
  lpv::Exposure out;
  if (in.exposure_case() != pb::Exposure::kEv) return out;
  if (!(std::abs(in.ev()) <= 40.0)) {
    return invalid("ev", "exposure.ev is " + std::to_string(in.ev()) + " stops, allowed are -40 to 40");
  }
  out.automatic = false;
  out.ev = in.ev();
  return out;
}

Expected<glm::ivec2> frameSize(int width, int height, const Limits& limits) {
  if (width == 0 && height == 0) return glm::ivec2(640, 360);
  if (Status s = checkEdge("width", width, limits); !s.ok()) return s;
  if (Status s = checkEdge("height", height, limits); !s.ok()) return s;
  return glm::ivec2(width, height);
}

Status checkRate(double rate) {
  if (rate == 0.0 || (rate >= 0.1 && rate <= 240.0)) return {};
  return invalid("max_rate",
                 "max_rate is " + std::to_string(rate) + " a second, allowed are 0 (the server's) and 0.1 to 240");
}

Expected<VolumeEncodingRequest> encodingRequestFrom(const pb::VolumeSubscription& in) {
  if (Status s = checkRate(in.max_rate()); !s.ok()) return s;
  Expected<VolumeEncodingRequest> order = commonVolume(in, true);
  if (!order) return order;
  if (in.tolerance_class() < 0 || in.tolerance_class() >= wire::kToleranceClasses) {
    return invalid("tolerance_class", "tolerance_class is " + std::to_string(in.tolerance_class()) +
                                          ", allowed are 0 to " + std::to_string(wire::kToleranceClasses - 1));
  }
  order->toleranceClass = in.tolerance_class();
  if (in.has_region()) {
    const Expected<Bounds> region = regionFrom(in.region());
    if (!region) return region.status();
    order->region = *region;
  }
  return order;
}

Expected<VolumeEncodingRequest> encodingRequestFrom(const pb::GetVolumeRequest& in) { return commonVolume(in, false); }

Expected<FrameEncodingRequest> encodingRequestFrom(const pb::FrameSubscription& in, const Limits& limits) {
  if (Status s = checkRate(in.max_rate()); !s.ok()) return s;
  const pb::Camera* camera = in.has_camera() && in.camera().has_camera() ? &in.camera().camera() : nullptr;
  Expected<FrameEncodingRequest> order = common(in, camera, kOfStreams, limits);
  if (order) order->subscription.cameraSequence = in.camera().sequence();
  return order;
}

Expected<FrameEncodingRequest> encodingRequestFrom(const pb::GetFrameRequest& in, const Limits& limits) {
  Expected<FrameEncodingRequest> order = common(in, in.has_camera() ? &in.camera() : nullptr, kOfCalls, limits);
  if (!order) return order;
  const Expected<FrameQuantity> quantity = quantityOf(in.quantity());
  if (!quantity) return quantity.status();
  if (*quantity == FrameQuantity::kRadiance) return order;
  order->subscription.quantity = *quantity;
  order->subscription.format = PixelFormat::kRgb32F;
  order->subscription.samples = 1;
  return order;
}

Expected<FrameSettings> updated(const FrameSettings& subscription, const pb::SubscriberUpdate& update,
                                const Limits& limits) {
  FrameSettings out = subscription;
  if (update.has_camera()) {
    const Expected<Camera> camera = fromProto(update.camera().camera());
    if (!camera) return camera.status().within("camera");
    out.camera = {*camera, {}};
    out.cameraSequence = update.camera().sequence();
  }
  if (update.width() != 0 || update.height() != 0) {
    const Expected<glm::ivec2> size = frameSize(update.width(), update.height(), limits);
    if (!size) return size.status();
    out.size = *size;
  }
  if (update.has_exposure()) {
    const Expected<lpv::Exposure> exposure = exposureFrom(update.exposure());
    if (!exposure) return exposure.status().within("exposure");
    out.exposure = *exposure;
  }
  return out;
}

}  // namespace lpv::api
