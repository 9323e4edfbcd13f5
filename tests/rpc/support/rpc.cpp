#include "rpc/support/rpc.h"

#include <gtest/gtest.h>
#include <openssl/sha.h>

#include <cstring>
#include <limits>
#include <ostream>

#include "lpv/convert.h"

namespace grpc {

void PrintTo(const Status& status, std::ostream* out) {
  *out << "code " << int(status.error_code()) << " \"" << status.error_message() << "\", field \""
       << lpv::rpc::fieldOf(status) << "\"";
}

}  // namespace grpc

namespace lpv::rpc {

namespace {

std::shared_ptr<grpc::Channel> ownChannel(const std::string& address, grpc::ChannelArguments arguments) {
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // a connection of its own, not one that tests share
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

}  // namespace

Stubs::Stubs(const std::string& address, grpc::ChannelArguments arguments)
    : Stubs(ownChannel(address, std::move(arguments))) {}

Stubs::Stubs(std::shared_ptr<grpc::Channel> existing) : channel(std::move(existing)) {
  server = pb::ServerService::NewStub(channel);
  session = pb::SessionService::NewStub(channel);
  blob = pb::BlobService::NewStub(channel);
  scene = pb::SceneService::NewStub(channel);
  result = pb::ResultService::NewStub(channel);
}

std::string fieldOf(const pb::Status& status) {
  pb::FieldViolation violation;
  if (status.details_size() == 0 || !status.details(0).UnpackTo(&violation)) return {};
  return violation.field();
}

std::string fieldOf(const grpc::Status& status) {
  pb::Status details;
  return details.ParseFromString(status.error_details()) ? fieldOf(details) : std::string();
}

std::string packed(const std::vector<float>& numbers) {
  return std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float));
}

std::string sha256(const std::string& bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest);
  std::string out;
  for (const unsigned char byte : digest) out.append({kDigits[byte >> 4], kDigits[byte & 0xF]});
  return out;
}

pb::Vec3 vec3(double x, double y, double z) { return client::toProto(glm::dvec3(x, y, z)); }

pb::Mesh quad(float e) {
  pb::Mesh mesh;
  mesh.set_positions(packed<float>({-e, -e, 0, e, -e, 0, e, e, 0, -e, e, 0}));
  mesh.set_indices(packed<std::uint32_t>({0, 1, 2, 0, 2, 3}));
  return mesh;
}

pb::Mesh sheet(int side) {
  pb::Mesh mesh;
  const auto place = [side](int i) { return float(i) / float(side - 1) - 0.5F; };
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) *mesh.mutable_positions() += packed<float>({place(x), place(y), 0.0F});
  }
  for (int y = 0; y + 1 < side; ++y) {
    for (int x = 0; x + 1 < side; ++x) {
      const auto a = std::uint32_t(y * side + x);
      const auto b = a + std::uint32_t(side);
      *mesh.mutable_indices() += packed<std::uint32_t>({a, a + 1, b + 1, a, b + 1, b});
    }
  }
  return mesh;
}

pb::Light light(const std::string& name, const pb::Mesh& mesh) {
  pb::Light out;
  out.set_name(name);
  *out.mutable_inline_mesh() = mesh;
  return out;
}

pb::Surface surface(const std::string& name, const pb::Mesh& mesh) {
  pb::Surface out;
  out.set_name(name);
  *out.mutable_inline_mesh() = mesh;
  return out;
}

pb::Operation moveTo(const std::string& light, const glm::dvec3& translation) {
  client::Move move;
  move.translation = translation;
  return client::moveLight(light, move);
}

pb::Camera camera(const glm::dvec3& eye, const glm::dvec3& target) {
  pb::Camera out;
  *out.mutable_eye() = client::toProto(eye);
  *out.mutable_target() = client::toProto(target);
  return out;
}

pb::SessionSettings settings(int cells) {
  pb::SessionSettings out;
  out.mutable_grid()->set_longest(cells);
  *out.mutable_grid()->mutable_bounds()->mutable_min() = vec3(-1, -1, -1);
  *out.mutable_grid()->mutable_bounds()->mutable_max() = vec3(1, 1, 1);
  return out;
}

pb::SessionSettings propagating(pb::SessionSettings settings) {
  settings.set_transport(pb::TRANSPORT_PROPAGATE);
  return settings;
}

std::string makeSession(Stubs& stubs, const pb::SessionSettings& settings) {
  pb::CreateSessionRequest request;
  *request.mutable_settings() = settings;
  pb::CreateSessionResponse response;
  const grpc::Status status = stubs.session->CreateSession(Call(), request, &response);
  EXPECT_THAT(status, IsOk());
  return response.session().name();
}

std::string makeLitSession(Stubs& stubs, int cells) {
  const std::string session = makeSession(stubs, settings(cells));
  apply(stubs, session, {client::createLight(light("Lamp"))});
  return session;
}

pb::Session getSession(Stubs& stubs, const std::string& session) {
  pb::GetSessionRequest request;
  request.set_name(session);
  pb::GetSessionResponse response;
  EXPECT_THAT(stubs.session->GetSession(Call(), request, &response), IsOk());
  return response.session();
}

pb::ClientIdentity join(Stubs& stubs, const std::string& session) {
  pb::JoinSessionRequest request;
  request.set_session(session);
  pb::JoinSessionResponse response;
  EXPECT_THAT(stubs.session->JoinSession(Call(), request, &response), IsOk());
  return response.client();
}

grpc::Status tryEdit(Stubs& stubs, const std::string& session, const pb::Edit& edit, pb::EditAck* ack,
                     const pb::ClientIdentity& client) {
  pb::ApplyEditRequest request;
  request.set_session(session);
  *request.mutable_edit() = edit;
  if (!client.client_id().empty()) *request.mutable_client() = client;
  pb::ApplyEditResponse response;
  const grpc::Status status = stubs.scene->ApplyEdit(Call(), request, &response);
  if (ack) *ack = response.ack();
  return status;
}

pb::EditAck apply(Stubs& stubs, const std::string& session, const std::vector<pb::Operation>& operations) {
  pb::EditAck ack;
  EXPECT_THAT(tryEdit(stubs, session, client::editOf(operations), &ack), IsOk());
  return ack;
}

pb::Light findLight(Stubs& stubs, const std::string& session, const std::string& name) {
  pb::ListLightsRequest request;
  request.set_session(session);
  pb::ListLightsResponse response;
  EXPECT_THAT(stubs.scene->ListLights(Call(), request, &response), IsOk());
  for (const pb::Light& each : response.lights()) {
    if (each.name() == name) return each;
  }
  ADD_FAILURE() << "no light \"" << name << "\"";
  return {};
}

grpc::Status upload(Stubs& stubs, const std::string& session, pb::BlobKind kind, const std::string& bytes,
                    pb::UploadBlobResponse* response, std::size_t partBytes) {
  pb::UploadBlobResponse ignored;
  Call call;
  const auto writer = stubs.blob->UploadBlob(call, response ? response : &ignored);
  pb::UploadBlobRequest request;
  request.mutable_header()->set_session(session);
  request.mutable_header()->set_kind(kind);
  request.mutable_header()->set_size(std::int64_t(bytes.size()));
  for (std::size_t offset = 0; offset < bytes.size(); offset += partBytes) {
    request.set_data(bytes.substr(offset, partBytes));
    if (!writer->Write(request)) break;
    request.Clear();
  }
  if (bytes.empty()) writer->Write(request);
  writer->WritesDone();
  return writer->Finish();
}

std::vector<glm::dvec3> probe(Stubs& stubs, const std::string& session,
                              const std::vector<std::pair<glm::dvec3, glm::dvec3>>& points) {
  pb::ProbeRequest request;
  request.set_session(session);
  for (const auto& [p, n] : points) *request.mutable_points() += packed<double>({p.x, p.y, p.z, n.x, n.y, n.z});
  pb::ProbeResponse response;
  EXPECT_THAT(stubs.result->Probe(Call(), request, &response), IsOk());
  std::vector<glm::dvec3> out(points.size(), glm::dvec3(std::numeric_limits<double>::quiet_NaN()));
  if (response.irradiance().size() != points.size() * sizeof(glm::dvec3)) {
    ADD_FAILURE() << "irradiance has " << response.irradiance().size() << " bytes";
    return out;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (response.valid()[i] == 1) std::memcpy(&out[i], response.irradiance().data() + i * sizeof out[i], sizeof out[i]);
  }
  return out;
}

client::Client clientOf(const std::string& address) {
  client::ConnectOptions options;
  options.address = address;
  return *client::Client::connect(options);
}

}  // namespace lpv::rpc
