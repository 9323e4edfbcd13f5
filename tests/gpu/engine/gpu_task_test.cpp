// The coroutine type alone: order, nesting, errors, abandonment.

#include "lpv/pacing/gpu_task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace lpv {
namespace {

GpuTask inner(std::string& log, int count) {
  for (int i = 0; i < count; ++i) {
    log += std::to_string(i);
    co_yield submitted(Stage::kInject, i);
  }
}

GpuTask outer(std::string& log) {
  log += "a";
  co_yield submitted(Stage::kUpload);
  co_await inner(log, 2);
  log += "b";
  co_await inner(log, 0);
  log += "c";
}

// Broken by: not going back to the parent at the end of a child.
TEST(PiecesTest, ChildrenRunAsPiecesOfTheirParent) {
  std::string log;
  GpuTask pieces = outer(log);
  EXPECT_EQ(log, "");
  pieces.resume();
  EXPECT_EQ(log, "a");
  EXPECT_EQ(pieces.pause().stage, Stage::kUpload);
  pieces.resume();
  EXPECT_EQ(log, "a0");
  EXPECT_EQ(pieces.pause().stage, Stage::kInject);
  pieces.resume();
  EXPECT_EQ(log, "a01");
  EXPECT_FALSE(pieces.done());
  pieces.resume();
  EXPECT_EQ(log, "a01bc");
  EXPECT_TRUE(pieces.done());
}

GpuTask failing() {
  co_yield submitted(Stage::kUpload);
  throw std::runtime_error("broken");
}

GpuTask around(bool& cleaned) {
  struct Guard {
    bool& flag;
    ~Guard() { flag = true; }
  } guard{cleaned};
  co_await failing();
}

// Broken by: swallowing the child's error.
TEST(PiecesTest, AChildsErrorReachesWhoResumes) {
  bool cleaned = false;
  GpuTask pieces = around(cleaned);
  pieces.resume();
  EXPECT_THROW(pieces.resume(), std::runtime_error);
  EXPECT_TRUE(cleaned);
}

TEST(PiecesTest, AbandoningDestroysChildrenAndLocals) {
  bool cleaned = false;
  {
    GpuTask pieces = around(cleaned);
    pieces.resume();
  }
  EXPECT_TRUE(cleaned);
}

}  // namespace
}  // namespace lpv
