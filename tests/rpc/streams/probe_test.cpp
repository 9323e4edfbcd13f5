// Probes and picks: irradiance at points and the object behind a pixel.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <thread>

#include "lpv/convert.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"
#include "scene/lookup.h"
#include "scene/volume.h"

namespace lpv::rpc {
namespace {

using Points = std::vector<std::pair<glm::dvec3, glm::dvec3>>;

class Probes : public ::testing::Test {
 protected:
  pb::PickResponse pick(const pb::PickRequest& request) {
    pb::PickResponse response;
    EXPECT_THAT(stubs_.result->Pick(Call(), request, &response), IsOk());
    return response;
  }

  Stubs stubs_{server().address()};
};

TEST_F(Probes, ProbesEqualALookupInTheVolume) {
  const std::string session = makeSession(stubs_, propagating(settings(16)));
  apply(stubs_, session, {client::createLight(light("Lamp"))});
  client::Client client = clientOf(server().address());
  pb::GetVolumeRequest request;
  request.set_session(session);
  request.set_format(pb::VOLUME_FORMAT_FLOAT);
  const Expected<client::VolumeResult> here = client.volume(request);
  ASSERT_TRUE(here.ok()) << here.status().message();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1.2, 1.2);
  Points points;
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 normal(place(random), place(random), place(random));
    points.emplace_back(glm::dvec3(place(random), place(random), place(random)), normal);
  }
  const std::vector<glm::dvec3> there = probe(stubs_, session, points);
  int outside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Irradiance e = irradianceAt(here->volume, Lookup::kSh2, points[i].first, glm::normalize(points[i].second));
    ASSERT_EQ(e.valid, !std::isnan(there[i].x)) << i;
    if (!e.valid) ++outside;
    for (int c = 0; c < 3 && e.valid; ++c) ASSERT_NEAR(there[i][c], e.rgb[c], 1e-6 * std::abs(e.rgb[c]) + 1e-15) << i;
  }
  EXPECT_GT(outside, 0);
  EXPECT_LT(outside, 900);
  // Many parts of a stream are one probe.
  Call call;
  const auto stream = stubs_.result->StreamProbe(call);
  std::thread writer([&] {
    for (std::size_t first = 0; first < points.size(); first += 37) {
      pb::StreamProbeRequest part;
      if (first == 0) part.mutable_request()->set_session(session);
      for (std::size_t i = first; i < std::min(first + 37, points.size()); ++i) {
        const auto& [p, n] = points[i];
        *part.mutable_request()->mutable_points() += packed<double>({p.x, p.y, p.z, n.x, n.y, n.z});
      }
      stream->Write(part);
    }
    stream->WritesDone();
  });
  std::string irradiance;
  std::string valid;
  pb::StreamProbeResponse answer;
  std::uint64_t revision = 0;
  while (stream->Read(&answer)) {
    irradiance += answer.response().irradiance();
    valid += answer.response().valid();
    if (revision != 0) {
      EXPECT_EQ(answer.response().result().revision(), revision);
    }
    revision = answer.response().result().revision();
  }
  writer.join();
  EXPECT_THAT(stream->Finish(), IsOk());
  ASSERT_EQ(valid.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    glm::dvec3 e;
    std::memcpy(&e, &irradiance[i * sizeof e], sizeof e);
    if (valid[i] == 1) {
      ASSERT_EQ(e, there[i]) << i;
    }
  }
}

/// Points at least three cells of 1/8 m from squares of 0.5 m in the planes z = 0 about (x, 0, 0), in any direction.
Points pointsAwayFrom(const std::vector<double>& squares, int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  Points points;
  while (points.size() < std::size_t(count)) {
    const glm::dvec3 p(place(random), place(random), place(random));
    bool far = true;
    for (const double x : squares) {
      const glm::dvec3 edge = glm::max(glm::abs(p - glm::dvec3(x, 0, 0)) - glm::dvec3(0.25, 0.25, 0), glm::dvec3(0));
      far = far && glm::length(edge) > 3.0 * 0.125;
    }
    if (far) points.emplace_back(p, glm::normalize(glm::dvec3(place(random), place(random), place(random))));
  }
  return points;
}

/// Away from lights the server's answer is a lookup in the volume that it hands out. Broken by: SH2 whatever the
/// settings say; the first layer only.
class AwayFromLights : public Probes, public ::testing::WithParamInterface<pb::Transport> {};

TEST_P(AwayFromLights, ProbesEqualALookupInEveryLayerOfTheVolume) {
  pb::SessionSettings wanted = settings(16);
  wanted.set_transport(GetParam());
  const std::string session = makeSession(stubs_, wanted);
  pb::Light left = light("Left");
  left.set_group("left");
  *left.mutable_transform()->mutable_translation() = vec3(-0.5, 0, 0);
  pb::Light right = light("Right");
  *right.mutable_transform()->mutable_translation() = vec3(0.5, 0, 0);
  *right.mutable_radiance() = vec3(1, 2, 3);
  apply(stubs_, session, {client::createLight(left), client::createLight(right)});
  client::Client client = clientOf(server().address());
  pb::GetVolumeRequest request;
  request.set_session(session);
  request.set_format(pb::VOLUME_FORMAT_FLOAT);
  const Expected<client::VolumeResult> here = client.volume(request);
  ASSERT_TRUE(here.ok()) << here.status().message();
  ASSERT_EQ(here->volume.layers.size(), 2U);
  const Points points = pointsAwayFrom({-0.5, 0.5}, 1000);
  // With DIRECT only who asks for the volume gets it.
  std::vector<client::SurfacePoint> asked;
  for (const auto& [position, normal] : points) asked.push_back({position, normal});
  const Expected<client::ProbeResult> answer =
      client.probe(session, asked, {.volumeOnly = GetParam() == pb::TRANSPORT_DIRECT});
  ASSERT_TRUE(answer.ok()) << answer.status().message();
  const Lookup lookup = client::fromProto(getSession(stubs_, session).settings().lookup());
  double brightest = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Irradiance e = irradianceAt(here->volume, lookup, points[i].first, points[i].second);
    ASSERT_TRUE(e.valid) << i;
    const glm::dvec3 g = here->volume.grid.gridFromWorld(points[i].first), dims(here->volume.grid.dims);
    const bool clamped = glm::any(glm::lessThan(g, glm::dvec3(0.5))) || glm::any(glm::greaterThan(g, dims - 0.5));
    if (clamped && GetParam() == pb::TRANSPORT_GATHER) continue;  // beyond the centres Probe looks at the lights
    brightest = std::max(brightest, e.rgb.z);
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(answer->irradiance[i].rgb[c], e.rgb[c], 1e-3 * e.rgb[c] + 1e-12) << i;
  }
  EXPECT_GT(brightest, 0.01);
}

INSTANTIATE_TEST_SUITE_P(All, AwayFromLights,
                         ::testing::Values(pb::TRANSPORT_PROPAGATE, pb::TRANSPORT_GATHER, pb::TRANSPORT_DIRECT),
                         [](const auto& row) { return pb::Transport_Name(row.param); });

TEST_F(Probes, APickFindsTheObjectAndNotItsNeighbour) {
  const std::string session = makeSession(stubs_);
  pb::Light left = light("Left");
  *left.mutable_transform()->mutable_translation() = vec3(-0.5, 0, 0);
  pb::Surface right = surface("Right");
  *right.mutable_transform()->mutable_translation() = vec3(0.5, 0, 0);
  pb::Surface behind = surface("Behind", quad(2.0F));
  *behind.mutable_transform()->mutable_translation() = vec3(0, 0, -0.9);
  apply(stubs_, session, {client::createLight(left), client::createSurface(right), client::createSurface(behind)});
  pb::PickRequest request;
  request.set_session(session);
  *request.mutable_camera() = camera({0, 0, 2}, {0, 0, 0});
  request.set_width(400);
  request.set_height(200);
  // 50 degrees over 200 pixels: 1 m at 2 m is 107 pixels.
  request.set_y(100);
  request.set_x(200 - 53.6);
  pb::PickResponse hit = pick(request);
  EXPECT_TRUE(hit.hit());
  EXPECT_EQ(hit.object(), "Left");
  EXPECT_EQ(hit.kind(), pb::OBJECT_KIND_LIGHT);
  EXPECT_NEAR(hit.position().x(), -0.5, 0.01);
  EXPECT_NEAR(hit.normal().z(), 1.0, 1e-6);
  EXPECT_NEAR(hit.distance(), std::sqrt(4.25), 0.01);
  EXPECT_EQ(hit.revision(), 1U);
  request.set_x(200 + 53.6);
  hit = pick(request);
  EXPECT_EQ(hit.object(), "Right");
  EXPECT_EQ(hit.kind(), pb::OBJECT_KIND_SURFACE);
  request.set_x(200);
  EXPECT_EQ(pick(request).object(), "Behind") << "between the two";
  *request.mutable_camera() = camera({0, 0, 2}, {0, 0, 9});
  hit = pick(request);
  EXPECT_FALSE(hit.hit());
  EXPECT_TRUE(hit.object().empty());
  request.set_x(401);
  pb::PickResponse response;
  EXPECT_THAT(stubs_.result->Pick(Call(), request, &response), Refused(StatusCode::OUT_OF_RANGE, "x", "400 x 200"));
  request.set_subscriber("s-nobody");
  EXPECT_THAT(stubs_.result->Pick(Call(), request, &response),
              Refused(StatusCode::NOT_FOUND, "subscriber", "s-nobody"));
}

}  // namespace
}  // namespace lpv::rpc
