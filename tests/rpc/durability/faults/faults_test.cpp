// Many clients, nothing lost: servers that are killed, stopped and restarted, connections that break, readers that
// stall; afterwards the checker decides from what everybody was told.
//
// LPV_FAULT_SECONDS: how long servers are killed (default 120). From 600 on (tests/soak), a server lives through a
// third of it instead, and its memory must not grow. LPV_FAULT_SEED: another order of faults.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "rpc/durability/faults/checker.h"
#include "rpc/durability/faults/run.h"

namespace lpv::rpc::faults {
namespace {

using std::chrono::seconds;
using ::testing::IsEmpty;

constexpr seconds kSoakFrom{600};
constexpr seconds kRun{12};            // of faults in one session
constexpr std::uint64_t kSameEdits{200};  // of each writer: sessions of one size, so that memory can be compared
constexpr double kMostBytesPerMinute = double(kMiB) / 10.0;

std::uint64_t fromEnvironment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

seconds wantedLength() { return seconds(fromEnvironment("LPV_FAULT_SECONDS", 120)); }

/// One run after another, each in a new session on the same servers, until `length` has passed.
class Soak {
 public:
  Soak(Service& service, bool kills) : service_(service), kills_(kills) {}

  void go(seconds length, std::uint64_t seed) {
    const auto start = std::chrono::steady_clock::now();
    while (!::testing::Test::HasFatalFailure()) {
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
      if (passed >= length) break;
      RunOptions options;
      options.seed = seed++;
      options.length = std::min<std::chrono::milliseconds>(kRun, length);
      options.kills = kills_;
      options.mostEdits = kills_ ? 0 : kSameEdits;
      const std::vector<Violation> found = check(run(service_, options, &tally_));
      EXPECT_THAT(found, IsEmpty()) << "seed " << options.seed << ":\n" << describe(found);
      const std::chrono::duration<double> now = std::chrono::steady_clock::now() - start;
      samples_.emplace_back(now.count() / 60.0, double(service_.residentBytes()));
      say(options.seed);
    }
  }
  const Tally& tally() const { return tally_; }

  /// Of the server's memory over the runs after the first third of them, which fill caches and pools: bytes a minute,
  /// least squares.
  double bytesPerMinute() const {
    const std::size_t first = samples_.size() / 3;
    const double n = double(samples_.size() - first);
    double t = 0.0, m = 0.0, tt = 0.0, tm = 0.0;
    for (std::size_t i = first; i < samples_.size(); ++i) {
      t += samples_[i].first / n;
      m += samples_[i].second / n;
    }
    for (std::size_t i = first; i < samples_.size(); ++i) {
      tt += (samples_[i].first - t) * (samples_[i].first - t);
      tm += (samples_[i].first - t) * (samples_[i].second - m);
    }
    return tt > 0.0 ? tm / tt : 0.0;
  }

 private:
  void say(std::uint64_t seed) const {
    std::printf("%6.1f min, seed %llu: %zu acknowledged, %zu again, %zu unknown, %zu reads, %d ends, %d other faults, ",
                samples_.back().first, static_cast<unsigned long long>(seed), tally_.accepted, tally_.repeated,
                tally_.unknown, tally_.reads, tally_.kills, tally_.otherFaults);
    std::printf("server %.1f MiB", samples_.back().second / double(kMiB));
    if (!service_.lives().empty())
      std::printf(", the one before %.1f MiB", double(service_.lives().back()) / double(kMiB));
    std::printf("\n");
    std::fflush(stdout);
  }

  Service& service_;
  const bool kills_;
  Tally tally_;
  std::vector<std::pair<double, double>> samples_;  ///< minutes, bytes
};

// Seen to fail when a repeated sequence is applied again, when outcomes are not stored, when one deletion is not told
// to readers, when a reader of another epoch gets a change instead of a snapshot.
TEST(Faults, NothingAcknowledgedIsLostAndNothingIsDoneTwice) {
  const seconds length = wantedLength();
  const bool soak = length >= kSoakFrom;
  const std::uint64_t seed = fromEnvironment("LPV_FAULT_SEED", 1);
  Service service;
  Soak killed(service, true);
  killed.go(soak ? length * 2 / 3 : length, seed);
  // A run that saw nothing of the kind would prove nothing.
  EXPECT_GT(killed.tally().kills, 0);
  EXPECT_GT(killed.tally().accepted, 0U);
  EXPECT_GT(killed.tally().repeated, 0U);
  EXPECT_GT(killed.tally().unknown, 0U);
}

TEST(Faults, AServerThatLivesLosesNothingAndDoesNotGrow) {
  const seconds length = wantedLength();
  const bool soak = length >= kSoakFrom;
  Service service;
  Soak alive(service, false);
  alive.go(soak ? length / 3 : kRun / 2, fromEnvironment("LPV_FAULT_SEED", 1) + 10'000);
  EXPECT_GT(alive.tally().accepted, 0U);
  if (!soak) return;  // too short to tell growth from noise
  std::printf("memory of the server that lived: %+.3f MiB in ten minutes\n",
              alive.bytesPerMinute() * 10.0 / double(kMiB));
  EXPECT_LE(alive.bytesPerMinute(), kMostBytesPerMinute);
}

/// A server that acknowledges before it stores (early_ack_main.cpp) has to be found out.
TEST(Faults, AServerThatAcknowledgesTooEarlyIsFoundOut) {
  constexpr int kRuns = 5;
  Service service(EARLY_ACK_PATH);
  Tally tally;
  bool found = false;
  for (int i = 0; i < kRuns && !found; ++i) {
    RunOptions options;
    options.seed = std::uint64_t(100 + i);
    options.length = seconds(4);
    const std::vector<Violation> violations = check(run(service, options, &tally));
    found = std::any_of(violations.begin(), violations.end(),
                        [](const Violation& violation) { return violation.fault == Fault::kLost; });
    std::printf("%s", describe(violations, 3).c_str());
  }
  EXPECT_TRUE(found) << tally.accepted << " acknowledged, " << tally.kills << " ends, and none of them missing";
}

}  // namespace
}  // namespace lpv::rpc::faults
