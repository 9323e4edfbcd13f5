#pragma once
// What result messages ask for, checked, as the session understands it.

#include "api/results/delta_chain.h"
#include "lpv/v1/result.pb.h"
#include "session/delivery/subscription.h"
#include "session/session.h"

namespace lpv::api {

namespace pb = lpv::v1;

/// A frame subscription and the coding its pixels get.
struct FrameEncodingRequest {
  FrameSettings subscription;
  pb::FrameFormat format = pb::FRAME_FORMAT_JPEG;
};

/// Defaults filled in; INVALID_ARGUMENT by field.
Expected<FrameEncodingRequest> encodingRequestFrom(const pb::FrameSubscription& subscription, const Limits& limits);
Expected<FrameEncodingRequest> encodingRequestFrom(const pb::GetFrameRequest& request, const Limits& limits);

Expected<VolumeEncodingRequest> encodingRequestFrom(const pb::VolumeSubscription& subscription);
Expected<VolumeEncodingRequest> encodingRequestFrom(const pb::GetVolumeRequest& request);

Expected<lpv::Exposure> exposureFrom(const pb::Exposure& exposure);
/// Both 0: 640 x 360.
Expected<glm::ivec2> frameSize(int width, int height, const Limits& limits);
Status checkRate(double rate);

/// `order.wish` changed as an update says; the session decides about camera sequences.
Expected<FrameSettings> updated(const FrameSettings& subscription, const pb::SubscriberUpdate& update,
                                const Limits& limits);

}  // namespace lpv::api
