// Everybody at once, for ThreadSanitizer: members edit, take back, lock, look and leave while streams read, sessions
// come, go to disk and come back, tokens are made and revoked, and the operator asks for numbers. A race is a failure
// by itself (the sanitizer ends the process); besides, nothing acknowledged may be missing afterwards.
//
// LPV_TSAN_ROUNDS: how often everybody does what they do (default 40).
//
// Seen to fail with a data race when Session::whenDurable reads its position without the session's lock.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <functional>
#include <optional>
#include <thread>
#include <vector>

#include "tsan/together.h"

namespace lpv::test {
namespace {

int rounds() {
  const char* given = std::getenv("LPV_TSAN_ROUNDS");
  return given ? std::atoi(given) : 40;
}

/// A caller's thread. Its rounds begin together with everybody's.
class Crowd {
 public:
  ~Crowd() { join(); }
  void add(std::function<void(int round)> act) {
    threads_.emplace_back([act = std::move(act)] {
      for (int round = 0; round < rounds(); ++round) act(round);
    });
  }
  void join() {
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

 private:
  std::vector<std::thread> threads_;
};

TEST_F(Together, EverybodyInOneRoom) {
  std::atomic<std::uint64_t> accepted{revision("sessions/room")};
  const pb::ClientIdentity a = join();
  const pb::ClientIdentity b = join();
  Crowd crowd;
  crowd.add([&](int round) { edit(a, round, accepted); });
  crowd.add([&](int round) { edit(b, round, accepted); });
  crowd.add([&](int) { takeBack(a, accepted); });
  crowd.add([&](int) { beSeen(b); });
  crowd.add([&](int) { streamEdits(5, accepted); });
  crowd.add([&](int round) { watchVolumes(round % 3 == 0); });
  crowd.add([&](int) { watchFrames(); });
  crowd.add([&](int) { watchScene(a); });
  crowd.add([&](int) { askForLight(); });
  crowd.add([&](int round) { upload(round); });
  crowd.add([&](int) { shareAndRevoke(); });
  crowd.add([&](int) { askForNumbers(); });
  crowd.add([&](int round) { comeAndGo(round); });
  crowd.add([&](int round) { copyTheRoom(round); });
  // Readers wait for news: there are some for as long as they need them.
  std::atomic<bool> over{false};
  std::thread wind([&] {
    const pb::ClientIdentity nobody;
    for (int round = 0; !over; ++round) edit(nobody, round, accepted);
  });
  crowd.join();
  over = true;
  wind.join();
  EXPECT_EQ(revision("sessions/room"), accepted) << "an edit that is accepted is one revision";
  EXPECT_GT(house().engine().ticks(), 0);
  // What was acknowledged is there for whoever comes next.
  house_.reset();
  house_ = std::make_unique<House>(folder_);
  EXPECT_EQ(revision("sessions/room"), accepted);
}

/// Sessions that live for a second without use are evicted and restored by the next call, several at once.
TEST_F(Together, EvictedSessionsAreRestoredOnce) {
  constexpr int kRooms = 3;
  for (int room = 0; room < kRooms; ++room) makeRoom("guest-room-" + std::to_string(room), 1);
  for (int time = 0; time < 2; ++time) {
    while (house().registry().all().size() > 1) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      house().registry().sweep();
    }
    std::vector<std::thread> callers;
    for (int caller = 0; caller < 2 * kRooms; ++caller) {
      callers.emplace_back(
          [&, caller] { EXPECT_EQ(revision("sessions/guest-room-" + std::to_string(caller % kRooms)), 1U); });
    }
    for (std::thread& caller : callers) caller.join();
  }
}

/// The server ends while everybody is busy: every call and stream ends, and nobody waits for ever.
TEST_F(Together, ADrainEndsEveryCall) {
  std::atomic<std::uint64_t> accepted{0};
  Crowd crowd;
  std::atomic<int> busy{0};
  for (int caller = 0; caller < 3; ++caller) {
    crowd.add([&](int round) {
      pb::ApplyEditRequest request;
      request.set_session("sessions/room");
      *request.mutable_edit()->add_operations() = moving(round);
      pb::ApplyEditResponse response;
      const Status status = house().ask(api::applyEdit, request, &response);
      if (status.ok()) ++accepted;
      EXPECT_TRUE(status.ok() || status.code() == Code::kUnavailable) << status.message();
      ++busy;
    });
  }
  pb::WatchVolumeRequest request;
  request.mutable_subscription()->set_session("sessions/room");
  const auto guest = Guest<pb::WatchVolumeRequest, pb::WatchVolumeResponse>::open(
      api::watchVolume(house().context()), request,
      [](const pb::WatchVolumeResponse&) { return std::optional<pb::WatchVolumeRequest>(); });
  while (busy < 3) std::this_thread::yield();
  EXPECT_TRUE(house().registry().quiesce().ok());
  house().registry().drain();
  EXPECT_EQ(guest->end().code(), Code::kUnavailable);
  guest->leave();
  crowd.join();
  house_.reset();
  house_ = std::make_unique<House>(folder_);
  EXPECT_EQ(revision("sessions/room"), 1 + accepted);
}

}  // namespace
}  // namespace lpv::test
