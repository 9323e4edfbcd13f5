// The light all around a point, over the wire: against the numbers that result.proto writes out, and against what falls
// on surfaces that face every way.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "lpv/convert.h"
#include "reference/meshes.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

/// The middles of the 6 sides and of the 8 corners of a cube.
std::vector<glm::dvec3> directions() {
  std::vector<glm::dvec3> out;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      glm::dvec3 n(0.0);
      n[axis] = side;
      out.push_back(n);
    }
  }
  for (int corner = 0; corner < 8; ++corner)
    out.push_back(glm::normalize(glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2) - 0.5));
  return out;
}

/// A box that is seen from outside, or a room.
pb::Mesh boxOf(double half, bool inward) {
  const MeshPtr mesh = reference::box(glm::dvec3(-half), glm::dvec3(half), inward);
  return client::toProto(*mesh);
}

class ProbesAround : public ::testing::Test {
 protected:
  /// A square of 1 m, 1 m above the origin, front down.
  static pb::Light overhead() {
    pb::Light out = light("Lamp", quad(0.5F));
    *out.mutable_transform()->mutable_translation() = vec3(0, 1, 0);
    out.mutable_transform()->mutable_rotation()->set_x(std::sqrt(0.5));
    out.mutable_transform()->mutable_rotation()->set_w(std::sqrt(0.5));
    return out;
  }
  static pb::SessionSettings direct() {
    pb::SessionSettings out = settings();
    out.set_transport(pb::TRANSPORT_DIRECT);
    return out;
  }
  client::ProbeResult around(const std::string& session, const std::vector<glm::dvec3>& places) {
    std::vector<client::SurfacePoint> points;
    for (const glm::dvec3& place : places) points.push_back({place});
    auto answer = client_.probe(session, points, {.around = true});
    EXPECT_TRUE(answer.ok()) << answer.status().message();
    return answer ? std::move(*answer) : client::ProbeResult();
  }
  /// D.n = E(n) - E(-n), whatever the light: vector irradiance by harmonics and by what falls on surfaces.
  void expectVectorIrradiance(const std::string& session, const glm::dvec3& at, double tolerance) {
    const client::LightAround light = around(session, {at}).around.at(0);
    std::vector<client::SurfacePoint> points;
    for (const glm::dvec3& n : directions()) {
      points.push_back({at, n});
      points.push_back({at, -n});
    }
    const auto answer = client_.probe(session, points);
    ASSERT_TRUE(answer.ok()) << answer.status().message();
    const double y1 = std::sqrt(0.75 / std::acos(-1.0)),
                 fluence = light.harmonics[0].x * 2.0 * std::sqrt(std::acos(-1.0));
    for (std::size_t i = 0; i < points.size(); i += 2) {
      const glm::dvec3 n = points[i].normal;
      const double d =
          double(light.harmonics[3].x) * n.x + double(light.harmonics[1].x) * n.y + double(light.harmonics[2].x) * n.z;
      EXPECT_NEAR(d / y1, answer->irradiance[i].rgb.x - answer->irradiance[i + 1].rgb.x, tolerance * fluence) << i;
    }
  }

  Stubs stubs_{server().address()};
  client::Client client_ = clientOf(server().address());
};

// Broken by: bytes in another order; the volume's bands in place of the lights'.
TEST_F(ProbesAround, HaveTheNumbersOfResultProto) {
  const std::string session = makeSession(stubs_, direct());
  apply(stubs_, session, {client::createLight(overhead())});
  const client::ProbeResult result = around(session, {{0, 0, 0}, {0, 2, 0}});
  ASSERT_EQ(result.around.size(), 2U);
  const double want[] = {0.2272, 0.3676, 0, 0, 0, 0, -0.2060, 0, -0.3568};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(result.around[0].harmonics[i].y, want[i], 5e-4) << i;
  EXPECT_NEAR(result.around[0].mainDirection.y, 1.0, 1e-6);
  EXPECT_NEAR(result.around[0].mainIrradiance.z, 0.7031, 5e-4);
  EXPECT_EQ(result.around[0].backFaces, 0);
  EXPECT_TRUE(result.irradiance[0].valid);
  EXPECT_NEAR(result.irradiance[0].rgb.x, 0.7523, 1e-4) << "E on a surface that faces up";
  EXPECT_EQ(result.around[1].harmonics[0], glm::vec3(0.0F)) << "behind the lamp";
  EXPECT_EQ(result.around[1].mainDirection, glm::dvec3(0, 1, 0));
}

// A mesh whose tree has a space of its own, turned, mirrored and stretched.
// Broken by: directions of that space (as large as the light itself).
TEST_F(ProbesAround, OfAMeshIsWhatFallsOnSurfaces) {
  const std::string session = makeSession(stubs_, direct());
  pb::Light lamp = light("Lamp", client::toProto(*reference::bumpySphere(3000)));
  *lamp.mutable_transform()->mutable_translation() = vec3(0.4, 0.3, -0.2);
  *lamp.mutable_transform()->mutable_scale() = vec3(0.6, -0.3, 0.4);
  lamp.mutable_transform()->mutable_rotation()->set_y(0.6);
  lamp.mutable_transform()->mutable_rotation()->set_w(0.8);
  *lamp.mutable_radiance() = vec3(3, 1, 1);
  apply(stubs_, session, {client::createLight(lamp)});
  for (const glm::dvec3& at : {glm::dvec3(-0.6, 0.1, 0.5), glm::dvec3(0.4, 0.9, -0.2), glm::dvec3(2, -1, 0)})
    expectVectorIrradiance(session, at, 0.015);  // a VPL that the horizon cuts
}

// A lamp in a room of grey walls: what these reflect is there, too; and a post in the way.
// Broken by: lights alone (a third of the fluence).
TEST_F(ProbesAround, HaveWhatSurfacesReflect) {
  const std::string session = makeSession(stubs_);
  pb::Surface room = surface("Room", boxOf(0.95, true));
  *room.mutable_albedo() = vec3(0.7, 0.7, 0.7);
  pb::Surface post = surface("Post", boxOf(0.1, false));
  *post.mutable_transform()->mutable_translation() = vec3(0.3, 0.3, 0.1);
  pb::Light lamp = overhead();
  *lamp.mutable_transform()->mutable_scale() = vec3(0.5, 0.5, 0.5);
  *lamp.mutable_transform()->mutable_translation() = vec3(0.1, 0.9, 0);
  apply(stubs_, session, {client::createLight(lamp), client::createSurface(room), client::createSurface(post)});
  for (const glm::dvec3& at : {glm::dvec3(-0.3, -0.2, 0.1), glm::dvec3(0.5, -0.4, 0.2), glm::dvec3(0, 0.2, -0.6)})
    expectVectorIrradiance(session, at, 0.03);
  const client::LightAround light = around(session, {{0.0, -0.5, -0.5}}).around.at(0);
  pb::SessionSettings dark = getSession(stubs_, session).settings();
  dark.set_bounces(0);
  pb::UpdateSessionRequest change;
  change.mutable_session()->set_name(session);
  *change.mutable_session()->mutable_settings() = dark;
  change.mutable_update_mask()->add_paths("settings.bounces");
  pb::UpdateSessionResponse changed;
  ASSERT_THAT(stubs_.session->UpdateSession(Call(), change, &changed), IsOk());
  const client::LightAround unreflected = around(session, {{0.0, -0.5, -0.5}}).around.at(0);
  EXPECT_GT(light.harmonics[0].x, 1.5F * unreflected.harmonics[0].x);
}

// Broken by: an answer from inside of a wall that nobody can tell from one of the room.
TEST_F(ProbesAround, KnowThatTheyAreInsideOfSomethingSolid) {
  const std::string session = makeSession(stubs_);
  pb::Surface crate = surface("Crate", boxOf(0.3, false));
  apply(stubs_, session, {client::createLight(overhead()), client::createSurface(crate)});
  const client::ProbeResult result = around(session, {{0.1, 0.1, 0}, {0.8, 0.1, 0}});
  EXPECT_FALSE(result.irradiance[0].valid);
  EXPECT_EQ(result.around[0].backFaces, 64);
  EXPECT_TRUE(result.irradiance[1].valid);
  EXPECT_EQ(result.around[1].backFaces, 0);
}

// Broken by: the limit of plain probes, whose calls would take a worker for a minute.
TEST_F(ProbesAround, AreFewerInAMessage) {
  const std::string session = makeLitSession(stubs_);
  pb::ProbeRequest request;
  request.set_session(session);
  request.set_around(true);
  for (int i = 0; i < 257; ++i) *request.mutable_points() += packed<double>({0, 0, 0.5, 0, 0, 1});
  pb::ProbeResponse response;
  EXPECT_THAT(stubs_.result->Probe(Call(), request, &response),
              Refused(StatusCode::INVALID_ARGUMENT, "points", "257, allowed are 256"));
  EXPECT_EQ(around(session, std::vector<glm::dvec3>(300, glm::dvec3(0, 0, 0.5))).around.size(), 300U)
      << "the client library sends several";
  request.mutable_points()->resize(48);
  request.set_volume_only(true);
  ASSERT_THAT(stubs_.result->Probe(Call(), request, &response), IsOk());
  std::array<float, 27> volume{};
  ASSERT_EQ(response.harmonics().size(), sizeof volume);
  std::memcpy(volume.data(), response.harmonics().data(), sizeof volume);
  EXPECT_GT(volume[0], 0.0F);
  for (std::size_t i = 12; i < 27; ++i) EXPECT_EQ(volume[i], 0.0F) << "a volume has no band 2";
  request.set_around(false);
  ASSERT_THAT(stubs_.result->Probe(Call(), request, &response), IsOk());
  EXPECT_EQ(response.harmonics().size() + response.main_light().size() + response.back_faces().size(), 0U);
}

// Each part of a stream has its own. Broken by: a wish that is read of the first message alone and forgotten.
TEST_F(ProbesAround, ComeInStreams) {
  const std::string session = makeLitSession(stubs_);
  Call call;
  const auto stream = stubs_.result->StreamProbe(call);
  for (int part = 0; part < 3; ++part) {
    pb::StreamProbeRequest request;
    if (part == 0) {
      request.mutable_request()->set_session(session);
      request.mutable_request()->set_around(true);
    }
    request.mutable_request()->set_points(packed<double>({0, 0, 0.5, 0, 0, 1}));
    ASSERT_TRUE(stream->Write(request));
  }
  stream->WritesDone();
  pb::StreamProbeResponse answer;
  int parts = 0;
  for (; stream->Read(&answer); ++parts) EXPECT_EQ(answer.response().harmonics().size(), 27 * sizeof(float));
  EXPECT_THAT(stream->Finish(), IsOk());
  EXPECT_EQ(parts, 3);
}

}  // namespace
}  // namespace lpv::rpc
