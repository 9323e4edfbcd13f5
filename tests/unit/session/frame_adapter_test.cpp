// Size and quality by how long acknowledgements take, over lines that are modelled: seconds = delay + bytes / rate.

#include "session/delivery/frame_adapter.h"

#include <gtest/gtest.h>

namespace lpv {
namespace {

constexpr FrameShape kWanted{{640, 360}, 85};

/// Bytes go by pixels, and halve from quality 85 to 50.
double bytesOf(const FrameShape& shape) {
  return 0.1 * shape.size.x * shape.size.y * (0.3 + 0.7 * shape.quality / 85.0);
}

struct Line {
  double delay = 0.0;           ///< seconds, both ways
  double bytesPerSecond = 1e9;

  double seconds(const FrameShape& shape) const { return delay + bytesOf(shape) / bytesPerSecond; }
};

/// Sends frames over the line; the shape of the last.
FrameShape send(FrameAdapter& adapter, const Line& line, int frames) {
  for (int i = 0; i < frames; ++i) adapter.acknowledged(line.seconds(adapter.shapeFor(kWanted)));
  return adapter.shapeFor(kWanted);
}

TEST(FrameAdapter, AFastLineGetsWhatIsAskedFor) {
  FrameAdapter adapter(20.0);
  EXPECT_EQ(send(adapter, {}, 1000), kWanted);
}

// Broken by: never going coarser; going on below what the line can carry.
TEST(FrameAdapter, ANarrowLineGetsCoarserFramesThatComeInTime) {
  FrameAdapter adapter(10.0);
  const Line narrow{0.005, 0.4 * bytesOf(kWanted) * 10.0};  // carries 4 of 10 as asked for
  const FrameShape shape = send(adapter, narrow, 200);
  EXPECT_LT(bytesOf(shape), bytesOf(kWanted));
  EXPECT_LE(narrow.seconds(shape), 1.15 * 0.1);
  EXPECT_GE(shape.quality, 30);
  const double ratio = double(shape.size.x) / shape.size.y;
  EXPECT_NEAR(ratio, 640.0 / 360.0, 0.05);
}

// Broken by: a step back for every step forth (finer without asking whether that would come in time).
TEST(FrameAdapter, ItSettles) {
  FrameAdapter adapter(10.0);
  const Line narrow{0.005, 0.4 * bytesOf(kWanted) * 10.0};
  send(adapter, narrow, 200);
  int changes = 0;
  for (int i = 0; i < 300; ++i) {
    const int before = adapter.level();
    send(adapter, narrow, 1);
    changes += adapter.level() != before ? 1 : 0;
  }
  EXPECT_LE(changes, 4);
}

// Broken by: never going finer again.
TEST(FrameAdapter, ItComesBack) {
  FrameAdapter adapter(10.0);
  send(adapter, {0.0, 0.05 * bytesOf(kWanted) * 10.0}, 100);
  EXPECT_GT(adapter.level(), 2);
  EXPECT_EQ(send(adapter, {0.0, 1e9}, 300), kWanted);
}

// A long line is no faster for smaller frames. Broken by: not looking whether coarser frames come sooner.
TEST(FrameAdapter, ALongLineIsNotNarrow) {
  FrameAdapter adapter(20.0);
  int coarse = 0;
  for (int i = 0; i < 1000; ++i) {
    send(adapter, {0.3, 1e9}, 1);
    coarse += adapter.level() > 0 ? 1 : 0;
  }
  EXPECT_LT(coarse, 150) << "tried now and then, and left";
}

TEST(FrameAdapter, OneLateFrameChangesNothing) {
  FrameAdapter adapter(10.0);
  send(adapter, {}, 50);
  adapter.acknowledged(0.2);
  EXPECT_EQ(send(adapter, {}, 1), kWanted);
}

// Broken by: scaling past the least edge that the server renders.
TEST(FrameAdapter, NoEdgeBecomesTooSmall) {
  FrameAdapter adapter(10.0);
  for (int i = 0; i < 200; ++i) adapter.acknowledged(5.0 / (1 + adapter.level()));
  EXPECT_EQ(adapter.level(), FrameAdapter::coarsest());
  EXPECT_EQ(adapter.shapeFor({{40, 17}, 85}).size, glm::ivec2(16, 16));
  EXPECT_EQ(adapter.shapeFor({{16, 16}, 1}), (FrameShape{{16, 16}, 1}));
}

}  // namespace
}  // namespace lpv
