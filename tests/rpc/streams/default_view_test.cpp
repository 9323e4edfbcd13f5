// What those see who give no camera.

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>

#include "lpv/convert.h"
#include "lpv/watch.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"
#include "scene/camera.h"

namespace lpv::rpc {
namespace {

class DefaultViews : public ::testing::Test {
 protected:
  pb::GetFrameRequest request() const {
    pb::GetFrameRequest request;
    request.set_session(session_);
    request.set_width(96);
    request.set_height(64);
    return request;
  }

  std::string frame(const pb::GetFrameRequest& request) {
    const auto frame = client_.frame(request);
    EXPECT_TRUE(frame.ok()) << frame.status().message();
    return frame ? frame->file : std::string();
  }

  /// What is in the middle of the picture, and how far away: tells cameras apart.
  pb::PickResponse middle() {
    pb::PickRequest request;
    request.set_session(session_);
    request.set_width(96);
    request.set_height(64);
    request.set_x(48);
    request.set_y(32);
    pb::PickResponse response;
    EXPECT_THAT(stubs_.result->Pick(Call(), request, &response), IsOk());
    EXPECT_TRUE(response.hit());
    return response;
  }

  Stubs stubs_{server().address()};
  client::Client client_ = clientOf(server().address());
  std::string session_ = makeLitSession(stubs_);
};

TEST_F(DefaultViews, ShowTheWholeScene) {
  apply(stubs_, session_, {client::createSurface(surface("Wall", quad(0.5F)))});
  pb::GetFrameRequest given = request();
  *given.mutable_camera() = client::toProto(defaultCamera({{-0.5, -0.5, 0}, {0.5, 0.5, 0}}));
  EXPECT_EQ(frame(request()), frame(given));
  *given.mutable_camera() = client::toProto(defaultCamera({{-0.5, -0.5, 0}, {0.5, 0.6, 0}}));
  EXPECT_NE(frame(request()), frame(given));
}

// Whoever draws handles into a picture has to know where it is seen from. Broken by: no camera in the header; the
// default of a camera.
TEST_F(DefaultViews, SayWhatTheyAreSeenThrough) {
  apply(stubs_, session_, {client::createSurface(surface("Wall", quad(0.5F)))});
  const auto chosen = client_.frame(request());
  ASSERT_TRUE(chosen.ok()) << chosen.status().message();
  EXPECT_TRUE(chosen->header.camera().name().empty());
  pb::GetFrameRequest given = request();
  *given.mutable_camera() = chosen->header.camera();
  EXPECT_EQ(frame(given), chosen->file);
  given.mutable_camera()->mutable_eye()->set_x(given.camera().eye().x() + 0.1);
  const auto moved = client_.frame(given);
  ASSERT_TRUE(moved.ok());
  EXPECT_EQ(moved->header.camera().SerializeAsString(), given.camera().SerializeAsString());
}

// With PROPAGATE, whose streams sample no near field: their pictures are those of single frames.
TEST_F(DefaultViews, AreTheSameInStreams) {
  session_ = makeSession(stubs_, propagating());
  apply(stubs_, session_, {client::createLight(light("Lamp"))});
  apply(stubs_, session_, {client::createSurface(surface("Wall", quad(0.5F)))});
  pb::FrameSubscription subscription;
  subscription.set_session(session_);
  subscription.set_width(96);
  subscription.set_height(64);
  subscription.set_format(pb::FRAME_FORMAT_PNG);
  subscription.set_samples(32);  // as frame() has them
  std::mutex mutex;
  std::string newest;
  const client::FrameWatcher watcher(client_, subscription, [&](const client::FrameResult& result) {
    const std::lock_guard lock(mutex);
    newest = result.file;
  });
  const auto shows = [&](const std::string& file) {
    const std::lock_guard lock(mutex);
    return newest == file;
  };
  const std::string before = frame(request());
  EXPECT_TRUE(eventually([&] { return shows(before); }));
  apply(stubs_, session_, {client::createSurface(surface("Large", quad(2.0F)))});
  const std::string after = frame(request());
  EXPECT_NE(before, after);
  EXPECT_TRUE(eventually([&] { return shows(after); }));
}

TEST_F(DefaultViews, StandStillWhileThingsMove) {
  apply(stubs_, session_, {client::createSurface(surface("Wall", quad(0.5F)))});
  const double distance = middle().distance();
  // Twice as wide as the wall would be another view, were it not for the wall's surroundings.
  for (const double x : {0.1, 0.6, -0.7, 0.0}) {
    apply(stubs_, session_, {moveTo("Lamp", {x, 0, -0.1})});
    EXPECT_EQ(middle().distance(), distance) << x;
  }
  apply(stubs_, session_, {client::deleteLight("Lamp")});
  EXPECT_NEAR(middle().distance(), distance, 1e-9);
  apply(stubs_, session_, {client::createSurface(surface("Large", quad(2.0F)))});
  EXPECT_GT(middle().distance(), 2.0 * distance);
}

TEST_F(DefaultViews, FollowWhatLeaves) {
  const double distance = middle().distance();
  apply(stubs_, session_, {moveTo("Lamp", {30, 0, 0})});
  EXPECT_NEAR(middle().distance(), distance, 1e-9);
  EXPECT_NEAR(middle().position().x(), 30.0, 1e-9);
}

TEST_F(DefaultViews, AreChosenAnewByAFit) {
  apply(stubs_, session_, {client::createSurface(surface("Wall", quad(0.5F)))});
  pb::UpdateSessionRequest update;
  update.mutable_session()->set_name(session_);
  update.mutable_session()->mutable_settings()->mutable_grid()->set_longest(8);
  update.mutable_update_mask()->add_paths("settings.grid");
  pb::UpdateSessionResponse updated;
  ASSERT_THAT(stubs_.session->UpdateSession(Call(), update, &updated), IsOk());
  const double distance = middle().distance();
  apply(stubs_, session_, {moveTo("Lamp", {0.7, 0, 0})});
  EXPECT_EQ(middle().distance(), distance);
  apply(stubs_, session_, {client::fitGrid()});
  EXPECT_GT(middle().distance(), 1.05 * distance);
}

}  // namespace
}  // namespace lpv::rpc
