// Calls for single results: volumes, frames, probes, picks.

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "assemble.h"
#include "connection.h"

namespace lpv::client {
namespace {

constexpr std::size_t kPointsPerProbe = 16384;
constexpr std::size_t kPointsPerProbeAround = 256;

Status incomplete() { return Status(Code::kInternal, "the server ended the call before the answer was complete"); }

/// Reads parts until the assembler has a result. The stream must end after it.
template <typename Result, typename Response, typename Assembler, typename Reader>
Expected<Result> assembleAll(Reader& reader, Call& call, const std::string& address) {
  Assembler assembler;
  std::optional<Result> result;
  Status fault;
  Response response;
  while (reader.Read(&response)) {
    if (!fault.ok()) continue;
    auto added = assembler.add(response.part());
    if (!added) {
      fault = added.status();
      call.context.TryCancel();
    } else if (*added) {
      result = std::move(**added);
    }
  }
  const grpc::Status status = reader.Finish();
  if (!fault.ok()) return fault;
  if (!status.ok()) return statusFrom(status, address);
  if (!result) return incomplete();
  return std::move(*result);
}

std::string packPoints(const std::vector<SurfacePoint>& points, std::size_t first, std::size_t count) {
  static_assert(std::endian::native == std::endian::little, "numbers travel as the machine holds them");
  std::string bytes;
  bytes.reserve(count * 48);
  for (std::size_t i = first; i < first + count; ++i) {
    const SurfacePoint& p = points[i];
    const double numbers[] = {p.position.x, p.position.y, p.position.z, p.normal.x, p.normal.y, p.normal.z};
    bytes.append(reinterpret_cast<const char*>(numbers), sizeof(numbers));
  }
  return bytes;
}

constexpr std::size_t kHarmonicsBytes = 27 * sizeof(float);
constexpr std::size_t kMainLightBytes = 6 * sizeof(double);

bool answersAll(const v1::ProbeResponse& response, std::size_t count, bool around) {
  if (response.irradiance().size() != count * 24 || response.valid().size() != count) return false;
  if (!around) return true;
  return response.harmonics().size() == count * kHarmonicsBytes &&
         response.main_light().size() == count * kMainLightBytes && response.back_faces().size() == count;
}

LightAround lightAround(const v1::ProbeResponse& response, std::size_t i) {
  LightAround out;
  static_assert(sizeof out.harmonics == kHarmonicsBytes);
  std::memcpy(out.harmonics.data(), response.harmonics().data() + i * kHarmonicsBytes, kHarmonicsBytes);
  std::array<double, 6> light{};
  std::memcpy(light.data(), response.main_light().data() + i * kMainLightBytes, kMainLightBytes);
  out.mainDirection = {light[0], light[1], light[2]};
  out.mainIrradiance = {light[3], light[4], light[5]};
  out.backFaces = int(static_cast<unsigned char>(response.back_faces()[i]));
  return out;
}

Status appendAnswers(const v1::ProbeResponse& response, std::size_t count, bool around, ProbeResult& out) {
  if (!answersAll(response, count, around)) {
    return Status(Code::kInternal, "the server answered for another number of points than were sent");
  }
  for (std::size_t i = 0; i < count; ++i) {
    double rgb[3];
    std::memcpy(rgb, response.irradiance().data() + i * 24, 24);
    out.irradiance.push_back({{rgb[0], rgb[1], rgb[2]}, response.valid()[i] != 0});
    if (around) out.around.push_back(lightAround(response, i));
  }
  return {};
}

}  // namespace

Expected<VolumeResult> Client::volume(const v1::GetVolumeRequest& request) {
  v1::GetVolumeRequest named = request;
  named.set_session(sessionName(request.session()));
  Call call(*connection_, timeFor(std::uint64_t(64) << 20U));
  const auto reader = connection_->results->GetVolume(&call.context, named);
  return assembleAll<VolumeResult, v1::GetVolumeResponse, VolumeAssembler>(*reader, call, address());
}

Expected<FrameResult> Client::frame(const v1::GetFrameRequest& request) {
  v1::GetFrameRequest named = request;
  named.set_session(sessionName(request.session()));
  Call call(*connection_, timeFor(std::uint64_t(16) << 20U));
  const auto reader = connection_->results->GetFrame(&call.context, named);
  return assembleAll<FrameResult, v1::GetFrameResponse, FrameAssembler>(*reader, call, address());
}

Expected<ProbeResult> Client::probe(const std::string& session, const std::vector<SurfacePoint>& points,
                                    const ProbeWish& wish) {
  const std::size_t most = wish.around ? kPointsPerProbeAround : kPointsPerProbe;
  ProbeResult result;
  result.irradiance.reserve(points.size());
  v1::ProbeRequest request;
  request.set_session(sessionName(session));
  request.set_volume_only(wish.volumeOnly);
  request.set_around(wish.around);
  if (wish.minRevision) request.set_min_revision(*wish.minRevision);
  for (std::size_t at = 0; at < points.size(); at += most) {
    const std::size_t count = std::min(most, points.size() - at);
    request.set_points(packPoints(points, at, count));
    auto response = unary(*connection_, *connection_->results, &v1::ResultService::Stub::Probe, request);
    if (!response) return response.status();
    if (Status status = appendAnswers(*response, count, wish.around, result); !status.ok()) return status;
    request.set_min_revision(std::max(request.min_revision(), response->result().revision()));
    result.info = std::move(*response->mutable_result());
  }
  return result;
}

Expected<v1::PickResponse> Client::pick(const v1::PickRequest& request) {
  v1::PickRequest named = request;
  named.set_session(sessionName(request.session()));
  return unary(*connection_, *connection_->results, &v1::ResultService::Stub::Pick, named);
}

}  // namespace lpv::client
