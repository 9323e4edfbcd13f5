// Calls in the future that are taken back.

#include "base/timers.h"

#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <string>

#include "api/call/deadline.h"

namespace lpv {
namespace {

using std::chrono::hours;

// Seen to fail when a deadline only forgets its call: 10^5 cancelled calls then held 20 MB of the server for a minute.
TEST(Timers, HoldNothingOfWhatWasTakenBack) {
  Timers timers;
  api::Deadline deadline(timers);
  auto held = std::make_shared<int>(0);
  const std::weak_ptr<int> first = held;
  deadline.restart(hours(1), [held] { ++*held; });
  held = std::make_shared<int>(0);
  const std::weak_ptr<int> second = held;
  EXPECT_FALSE(first.expired());
  deadline.restart(hours(1), [held] { ++*held; });
  EXPECT_TRUE(first.expired()) << "put off";
  held.reset();
  EXPECT_FALSE(second.expired());
  deadline.stop();
  EXPECT_TRUE(second.expired()) << "taken back";
}

// The first call keeps the thread until the second has been taken back.
TEST(Timers, CallInOrderWhatWasNotTakenBack) {
  Timers timers;
  std::promise<void> goOn;
  std::promise<void> last;
  std::string called;
  const auto now = Clock::now();
  timers.at(now, [&] {
    goOn.get_future().wait();
    called += "a";
  });
  const Timers::Key key = timers.at(now, [&] { called += "b"; });
  timers.at(now, [&] {
    called += "c";
    last.set_value();
  });
  timers.cancel(key);
  timers.cancel(key);
  timers.cancel({});
  goOn.set_value();
  last.get_future().wait();
  timers.stop();
  EXPECT_EQ(called, "ac");
}

}  // namespace
}  // namespace lpv
