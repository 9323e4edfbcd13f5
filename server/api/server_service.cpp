
#include "api/call/method_table.h"
#include "api/services.h"
#include "convert/session.h"
#include "ops/process.h"
#include "session/limit_table.h"
#include "wire/message_size.h"

namespace lpv::api {
namespace {

constexpr const char* kFeatures[] = {
    "injection.count",
    "injection.flux",
    "injection.textures",
    "injection.directions",
    "method.compute",
    "method.raster",
    "method.dense",
    "transport.propagate",
    "transport.gather",
    "transport.direct",
    "transport.auto",
    "quality.accurate",
    "max_error",
    "grid.automatic",
    "lookup.sh2",
    "lookup.cap",
    "lookup.nearest",
    "lights.groups",
    "frames.jpeg",
    "frames.png",
    "frames.exr",
    "volume.half",
    "volume.float",
    "volume.compact",
    "volume.deltas",
    "volume.regions",
    "sessions.files",
    "self_check",
    "access.tokens",
    "tls",
    "edits.undo",
    "presence",
    "locks",
};

void set(pb::Limits* out, const google::protobuf::FieldDescriptor* field, int value) {
  out->GetReflection()->SetInt32(out, field, value);
}

void set(pb::Limits* out, const google::protobuf::FieldDescriptor* field, std::int64_t value) {
  out->GetReflection()->SetInt64(out, field, value);
}

void set(pb::Limits* out, const google::protobuf::FieldDescriptor* field, double value) {
  out->GetReflection()->SetDouble(out, field, value);
}

void set(pb::Limits* out, const google::protobuf::FieldDescriptor* field, std::chrono::seconds value) {
  google::protobuf::Duration duration;
  duration.set_seconds(value.count());
  out->GetReflection()->MutableMessage(out, field)->CopyFrom(duration);
}

/// Those of the table by name, and those that nobody sets.
void limitsToProto(const Limits& in, pb::Limits* out) {
  forEachLimit([&](const auto& row) { set(out, pb::Limits::descriptor()->FindFieldByName(row.name), in.*row.value); });
  out->set_max_cells_per_axis(kMaxCellsPerAxis);
  out->set_max_message_bytes(int(wire::kMaxMessageBytes));
  out->set_max_operations_per_edit(in.maxOperationsPerEdit);
  out->set_max_frame_edge(in.maxFrameEdge);
  out->set_max_probe_points(in.maxProbePoints);
  out->set_max_groups(kMaxGroups);
  out->set_max_undo_steps(in.maxUndoSteps);
}

}  // namespace

Status getServerInfo(const Context& context, const pb::GetServerInfoRequest&, pb::GetServerInfoResponse* response) {
  response->set_version(context.version);
  pb::Device* device = response->mutable_device();
  device->set_name(context.device.name);
  device->set_vendor(context.device.vendor);
  device->set_version(context.device.version);
  device->set_platform(context.device.platform);
  device->set_software(context.device.software);
  limitsToProto(context.limits, response->mutable_limits());
  response->mutable_start_time()->set_seconds(
      std::chrono::duration_cast<std::chrono::seconds>(context.started.time_since_epoch()).count());
  response->set_durability(toProto(context.registry->durability()));
  for (const char* feature : kFeatures) response->add_features(feature);
  return {};
}

Status getStats(const Context& context, const pb::GetStatsRequest&, pb::GetStatsResponse* response) {
  const SessionTotals totals = context.registry->totals();
  response->set_sessions(int(totals.sessions));
  response->set_subscribers(int(totals.subscribers));
  response->set_ticks(context.counters->ticks);
  response->set_results_sent(context.counters->resultsSent);
  response->set_result_bytes_sent(context.counters->resultBytesSent());
  response->set_volumes_encoded(context.counters->volumesEncoded);
  response->set_edits_accepted(context.counters->editsAccepted);
  response->set_edits_rejected(context.counters->editsRejected.total());
  response->set_blobs(std::int64_t(totals.blobs));
  response->set_blob_bytes(totals.blobBytes);
  response->set_resident_bytes(ops::processUse().residentBytes);
  if (totals.worstMeasuredError) response->set_worst_measured_error(*totals.worstMeasuredError);
  const auto uptime = std::chrono::system_clock::now() - context.started;
  response->mutable_uptime()->set_seconds(std::chrono::duration_cast<std::chrono::seconds>(uptime).count());
  return {};
}

std::vector<Method> serverMethods() {
  return {
      {"ServerService.GetServerInfo", Role::kViewer, "", handler(getServerInfo)},
      {"ServerService.GetStats", Role::kAdmin, "", handler(getStats)},
  };
}

}  // namespace lpv::api
