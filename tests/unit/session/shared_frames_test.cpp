// Frames that several readers see, made and encoded once.
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "api/results/parts.h"
#include "unit/session/session_fixture.h"

namespace lpv {
namespace {

class SharedFramesTest : public test::SessionTest {
 protected:
  static Subscription through(const Camera& camera, const glm::ivec2& size = {640, 360}) {
    Subscription subscription;
    subscription.frame = FrameSettings();
    subscription.frame->camera.camera = camera;
    subscription.frame->size = size;
    return subscription;
  }
  struct Reader {
    std::shared_ptr<test::Inbox> inbox = std::make_shared<test::Inbox>();
    std::shared_ptr<Subscriber> subscriber = nullptr;
  };
  Reader reader(const Subscription& subscription) {
    Reader out;
    out.subscriber = subscribed(out.inbox, subscription);
    return out;
  }
  /// All have their credit back before the next tick, which is one of all of them.
  void acknowledgeAll(const std::vector<Reader>& readers) {
    for (const Reader& r : readers) acknowledge(r.subscriber, r.inbox->last().meta.resultId);
  }
};

// Seen to fail when each has its own, and when the size or what it shows is not looked at.
TEST_F(SharedFramesTest, ReadersOfOneCameraAreMadeOne) {
  const Camera camera;
  Camera elsewhere;
  elsewhere.eye.x = 1.0;
  Subscription coarse = through(camera);
  coarse.frame->quality = 30;
  coarse.frame->cameraSequence = 7;
  const std::vector<Reader> readers = {reader(through(camera)), reader(coarse), reader(through(elsewhere)),
                                       reader(through(camera, {320, 180})), reader(through(camera))};
  acknowledgeAll(readers);
  const int before = rig_.engine.reducedFrames();
  edited();
  EXPECT_EQ(rig_.engine.reducedFrames() - before, 3);
  std::vector<FramePtr> got;
  for (const Reader& r : readers) {
    ASSERT_EQ(r.inbox->count(), 2U);
    got.push_back(r.inbox->last().frame);
  }
  EXPECT_EQ(got[1], got[0]);
  EXPECT_EQ(got[4], got[0]);
  EXPECT_NE(got[2], got[0]);
  EXPECT_NE(got[3], got[0]);
  EXPECT_EQ(readers[1].inbox->last().quality, 30);
  EXPECT_EQ(readers[1].inbox->last().cameraSequence, 7U);
  EXPECT_NE(readers[1].inbox->last().meta.resultId, readers[0].inbox->last().meta.resultId);
}

TEST_F(SharedFramesTest, CallsHaveTheirOwnBesideThem) {
  const Reader watching = reader(through(Camera()));
  acknowledgeAll({watching});
  FramePtr answered;
  WaitingCall call;
  call.frame = *through(Camera()).frame;
  call.minRevision = session_->summary().revision + 1;
  call.done = [&answered](const Expected<Result>& result) { answered = result->frame; };
  session_->delivery().ask(std::move(call));
  edited();
  ASSERT_NE(answered, nullptr);
  EXPECT_EQ(watching.inbox->count(), 2U);
  EXPECT_NE(answered, watching.inbox->last().frame);
}

// Seen to fail when each is made for one alone.
TEST_F(SharedFramesTest, OneSharpFrameServesAllWhoRest) {
  Subscription subscription = through(Camera());
  subscription.frame->sharpen = true;
  const std::vector<Reader> readers = {reader(subscription), reader(subscription), reader(subscription)};
  acknowledgeAll(readers);
  const int ticks = rig_.engine.ticks();
  ASSERT_TRUE(test::eventually([&] { return readers[2].inbox->count() == 2; }));
  rig_.settle();
  EXPECT_EQ(rig_.engine.ticks() - ticks, 1);
  EXPECT_TRUE(readers[2].inbox->last().sharp);
  EXPECT_EQ(readers[2].inbox->last().frame, readers[1].inbox->last().frame);
}

FramePtr picture() {
  auto frame = std::make_shared<Frame>();
  frame->size = {64, 48};
  for (int i = 0; i < 64 * 48 * 3; ++i) frame->rgb8.push_back(std::uint8_t(i * 7));
  return frame;
}

// Seen to fail when the quality is not looked at, and when every one is encoded.
TEST(FrameEncodings, EncodeAFrameOnceForAllWhoWantTheSame) {
  WorkerPool pool(2);
  api::FrameEncodings encodings;
  const FramePtr frame = picture(), other = picture();
  const auto file = [&](const FramePtr& of, api::pb::FrameFormat format, int quality) {
    return *encodings.get(of, format, quality, pool);
  };
  const auto first = file(frame, api::pb::FRAME_FORMAT_JPEG, 85);
  std::vector<api::FrameFile> together(8);
  std::vector<std::thread> workers;
  for (api::FrameFile& each : together)
    workers.emplace_back([&] { each = file(other, api::pb::FRAME_FORMAT_JPEG, 85); });
  for (std::thread& worker : workers) worker.join();
  for (const api::FrameFile& each : together) EXPECT_EQ(each, together[0]);
  EXPECT_NE(together[0], first);
  EXPECT_EQ(*together[0], *first);
  EXPECT_EQ(file(frame, api::pb::FRAME_FORMAT_JPEG, 85), first);
  EXPECT_LT(file(frame, api::pb::FRAME_FORMAT_JPEG, 30)->size(), first->size());
  EXPECT_NE(*file(frame, api::pb::FRAME_FORMAT_PNG, 85), *first);
  for (int i = 0; i < 2; ++i)  // its pixels are bytes
    EXPECT_FALSE(encodings.get(frame, api::pb::FRAME_FORMAT_EXR, 85, pool).ok());
}

}  // namespace
}  // namespace lpv
