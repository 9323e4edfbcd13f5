// How light enters the grid, as clients choose and see it: the injected stage of the volume.

#include <gtest/gtest.h>

#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

constexpr double kLobe0 = 0.88622692545275801365;  // sqrt(pi) / 2

class Injected : public ::testing::Test {
 protected:
  Volume injected(const std::string& session) {
    client::Client client = clientOf(server().address());
    pb::GetVolumeRequest request;
    request.set_session(session);
    request.set_format(pb::VOLUME_FORMAT_FLOAT);
    request.set_stage(pb::VOLUME_STAGE_INJECTED);
    Expected<client::VolumeResult> result = client.volume(request);
    EXPECT_TRUE(result.ok()) << result.status().message();
    const auto& features = result->header.result().features();
    features_.assign(features.begin(), features.end());
    return std::move(result->volume);
  }

  /// Emitted radiance integrated over area, per colour, W/sr: the sum of L00 over cells / c0 (MATHS.md 2).
  static glm::dvec3 emitted(const Volume& volume) {
    glm::dvec3 sum(0.0);
    const std::vector<float>& values = volume.layers.front().coefficients;
    for (std::size_t cell = 0; cell < values.size() / 12; ++cell) {
      for (int c = 0; c < 3; ++c) sum[c] += double(values[12 * cell + 4 * std::size_t(c)]);
    }
    return sum / kLobe0;
  }

  static pb::SessionSettings settingsOf(pb::Injection injection, pb::InjectionMethod method) {
    pb::SessionSettings s = settings();
    s.set_injection(injection);
    s.set_method(method);
    if (method == pb::INJECTION_METHOD_DENSE) s.set_dense_samples(1000);
    return s;
  }

  Stubs stubs_{server().address()};
  std::vector<std::string> features_;
};

/// A square of 1 m with texture coordinates across it.
pb::Mesh picture() {
  pb::Mesh mesh = quad(0.5F);
  mesh.set_uvs(packed<float>({0, 0, 1, 0, 1, 1, 0, 1}));
  return mesh;
}

pb::Light lampOf(const pb::Mesh& mesh, double x = 0.013) {
  pb::Light lamp = light("Lamp", mesh);
  *lamp.mutable_radiance() = vec3(4, 2, 1);
  *lamp.mutable_transform()->mutable_translation() = vec3(x, 0.027, 0.041);
  return lamp;
}

TEST_F(Injected, FluxHasTheLightsPower) {
  const std::string session = makeSession(stubs_, settingsOf(pb::INJECTION_FLUX, pb::INJECTION_METHOD_COMPUTE));
  apply(stubs_, session, {client::createLight(lampOf(quad(0.5F)))});
  const glm::dvec3 sum = emitted(injected(session));
  EXPECT_NEAR(sum.r, 4.0, 4e-6);
  EXPECT_NEAR(sum.g, 2.0, 2e-6);
  EXPECT_NEAR(sum.b, 1.0, 1e-6);
  EXPECT_THAT(features_, ::testing::Contains("flux"));
}

TEST_F(Injected, MethodsAgree) {
  std::vector<Volume> volumes;
  for (const auto method : {pb::INJECTION_METHOD_COMPUTE, pb::INJECTION_METHOD_RASTER, pb::INJECTION_METHOD_DENSE}) {
    const std::string session = makeSession(stubs_, settingsOf(pb::INJECTION_FLUX, method));
    apply(stubs_, session, {client::createLight(lampOf(quad(0.5F)))});
    volumes.push_back(injected(session));
  }
  EXPECT_THAT(features_, ::testing::Contains("dense"));
  EXPECT_EQ(volumes[0].layers[0].coefficients, volumes[1].layers[0].coefficients);
  EXPECT_NE(volumes[0].layers[0].coefficients, volumes[2].layers[0].coefficients);
  EXPECT_NEAR(emitted(volumes[2]).r, 4.0, 1e-5) << "samples are inside the grid, whichever cell they fall in";
}

TEST_F(Injected, ATextureIsPartOfTheLight) {
  const std::string session = makeSession(stubs_, settingsOf(pb::INJECTION_FLUX, pb::INJECTION_METHOD_COMPUTE));
  pb::Texture texture;
  texture.set_width(2);
  texture.set_height(1);
  texture.set_format(pb::TEXTURE_FORMAT_RGB32F);
  texture.set_texels(packed<float>({1, 0, 0.5, 0, 1, 0.5}));
  pb::UploadBlobResponse uploaded;
  ASSERT_THAT(upload(stubs_, session, pb::BLOB_KIND_TEXTURE, texture.SerializeAsString(), &uploaded), IsOk());
  pb::Light lamp = lampOf(picture());
  lamp.set_texture(uploaded.hash());
  apply(stubs_, session, {client::createLight(lamp)});
  const glm::dvec3 sum = emitted(injected(session));
  EXPECT_NEAR(sum.r, 2.0, 2e-6);  // half of the picture is red, half green
  EXPECT_NEAR(sum.g, 1.0, 1e-6);
  EXPECT_NEAR(sum.b, 0.5, 1e-6);
  EXPECT_THAT(features_, ::testing::Contains("textures"));
  // A texture must be one of this session's.
  pb::Light lost = lampOf(picture());
  lost.set_texture(std::string(64, '0'));
  EXPECT_THAT(tryEdit(stubs_, session, client::editOf({client::createLight(lost)})), HasCode(StatusCode::NOT_FOUND));
}

TEST_F(Injected, DirectionsTurnTheLight) {
  const std::string session = makeSession(stubs_, settingsOf(pb::INJECTION_FLUX, pb::INJECTION_METHOD_COMPUTE));
  pb::Mesh mesh = quad(0.5F);  // its normal is +z
  mesh.set_directions(packed<float>({1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}));
  apply(stubs_, session, {client::createLight(lampOf(mesh))});
  const Volume volume = injected(session);
  EXPECT_NEAR(emitted(volume).r, 4.0, 4e-6);
  glm::dvec3 towards(0.0);  // band 1 of red: (y, z, x)
  const std::vector<float>& values = volume.layers.front().coefficients;
  for (std::size_t cell = 0; cell < values.size() / 12; ++cell)
    towards += glm::dvec3(values[12 * cell + 3], values[12 * cell + 1], values[12 * cell + 2]);
  EXPECT_GT(towards.x, 1.0);
  EXPECT_NEAR(towards.y, 0.0, 1e-5);
  EXPECT_NEAR(towards.z, 0.0, 1e-5);
  EXPECT_THAT(features_, ::testing::Contains("directions"));
}

TEST_F(Injected, TheMethodCanBeChangedOnTheWay) {
  const std::string session = makeSession(stubs_, settingsOf(pb::INJECTION_COUNT, pb::INJECTION_METHOD_COMPUTE));
  apply(stubs_, session, {client::createLight(lampOf(quad(0.5F)))});
  const double counted = emitted(injected(session)).r;
  EXPECT_GT(counted, 4.1) << "COUNT takes every touched cell's whole face";
  pb::UpdateSessionRequest request;
  request.mutable_session()->set_name(session);
  request.mutable_session()->mutable_settings()->set_injection(pb::INJECTION_FLUX);
  request.mutable_update_mask()->add_paths("settings.injection");
  pb::UpdateSessionResponse response;
  ASSERT_THAT(stubs_.session->UpdateSession(Call(), request, &response), IsOk());
  EXPECT_NEAR(emitted(injected(session)).r, 4.0, 4e-6);
}

}  // namespace
}  // namespace lpv::rpc
