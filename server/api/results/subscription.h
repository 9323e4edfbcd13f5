#pragma once
// What result messages ask for, checked, as the session understands it.

#include "api/results/delta_chain.h"
#include "lpv/v1/result.pb.h"
#include "session/delivery/results.h"
#include "session/session.h"

namespace lpv::api {

namespace pb = lpv::v1;

/// A frame wish and the coding its pixels get.
struct FrameOrder {
  FrameWish wish;
  pb::FrameFormat format = pb::FRAME_FORMAT_JPEG;
};

/// Defaults filled in; INVALID_ARGUMENT by field.
Expected<FrameOrder> orderFrom(const pb::FrameSubscription& subscription, const Limits& limits);
Expected<FrameOrder> orderFrom(const pb::GetFrameRequest& request, const Limits& limits);

Expected<VolumeOrder> orderFrom(const pb::VolumeSubscription& subscription);
Expected<VolumeOrder> orderFrom(const pb::GetVolumeRequest& request);

Expected<lpv::Exposure> exposureFrom(const pb::Exposure& exposure);
/// Both 0: 640 x 360.
Expected<glm::ivec2> frameSize(int width, int height, const Limits& limits);
Status checkRate(double rate);

/// `order.wish` changed as an update says; the session decides about camera sequences.
Expected<FrameWish> updated(const FrameWish& wish, const pb::SubscriberUpdate& update, const Limits& limits);

}  // namespace lpv::api
