// What is paced, on a clock of its own: edits at the rate itself wait for nothing, and no more than the rate comes
 // through.

#include "session/delivery/pacer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <random>

namespace lpv {
namespace {

using namespace std::chrono_literals;

constexpr Clock::duration kInterval = 33ms;
constexpr Clock::time_point kBegin{10h};

struct Seen {
  Clock::duration longestWait{};
  int ticks = 0;
};

/// Ticks for edits that come every `period`, each up to `late` too late; a tick shows all edits before it.
Seen run(Clock::duration period, Clock::duration late, int edits) {
  std::mt19937 random(3);
  Pacer pacer(Pacer::Slack::kAnInterval);
  Seen seen;
  Clock::time_point last{};
  for (int i = 0; i < edits; ++i) {
    const Clock::duration lateness = late * std::uniform_int_distribution(0, 100)(random) / 100;
    const Clock::time_point edit = kBegin + i * period + lateness;
    if (edit <= last) continue;  // shown already
    last = std::max(edit, pacer.next());
    pacer.begin(last, kInterval);
    ++seen.ticks;
    seen.longestWait = std::max(seen.longestWait, last - edit);
  }
  return seen;
}

// Broken by: the next tick a whole interval after the last began, so that one late edit puts off all that follow.
TEST(Pacer, UnevenEditsAtTheRateDoNotWait) {
  const Seen seen = run(kInterval, 20ms, 1000);
  EXPECT_EQ(seen.ticks, 1000);
  EXPECT_EQ(seen.longestWait, 0ms);
}

// A thousand intervals have as many ticks, one that begins the first, and one more at once. Broken by: no limit; a
// pause that is saved up.
TEST(Pacer, NoMoreThanTheRateComesThrough) {
  const Seen seen = run(1ms, 0ms, 33000);
  EXPECT_LE(seen.ticks, 1002);
  EXPECT_GE(seen.ticks, 999);
  Pacer pacer(Pacer::Slack::kAnInterval);
  pacer.begin(kBegin, kInterval);
  const Clock::time_point later = kBegin + 1h;
  pacer.begin(later, kInterval);
  EXPECT_EQ(pacer.next(), later);  // one more at once, and no more
  pacer.begin(later, kInterval);
  EXPECT_EQ(pacer.next(), later + kInterval);
}

// What a subscriber asks for. Broken by: slack there, too.
TEST(Pacer, WithoutSlackTwoAreNeverNearerThanAnInterval) {
  Pacer pacer(Pacer::Slack::kNone);
  for (const Clock::time_point now : {kBegin, kBegin + 40ms, kBegin + 1h}) {
    pacer.begin(now, kInterval);
    EXPECT_EQ(pacer.next(), now + kInterval);
  }
}

}  // namespace
}  // namespace lpv
