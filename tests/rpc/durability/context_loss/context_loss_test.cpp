// A device that is reset again and again: clients see what they would have seen without, a little later.

#include <gtest/gtest.h>

#include <map>
#include <mutex>
#include <set>

#include "lpv/watch.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

constexpr int kMoves = 30;

/// What watchers were shown: checksums of volumes, and whether anything else happened to a stream.
struct Shown {
  std::mutex mutex;
  std::map<std::uint64_t, std::uint64_t> volumes;  ///< by revision
  std::set<std::uint64_t> epochs;
  std::uint64_t newestFrame = 0;  ///< revision
  int broken = 0;

  client::WatchHooks hooks() {
    client::WatchHooks out;
    out.reopening = [this](const Status&) { note(); };
    out.ended = [this](const Status&) { note(); };
    return out;
  }
  void note() {
    const std::lock_guard lock(mutex);
    ++broken;
  }
  void add(const pb::ResultInfo& volume) {
    const std::lock_guard lock(mutex);
    volumes[volume.revision()] = volume.checksum();
    epochs.insert(volume.epoch());
  }
  bool sawAll(std::uint64_t revision) {
    const std::lock_guard lock(mutex);
    return volumes.count(revision) != 0 && newestFrame >= revision;
  }
};

/// The same story on any server: a lamp goes across a room while two watch.
void tell(const std::string& address, Shown& shown) {
  Stubs stubs(address);
  client::Client client = clientOf(address);
  const std::string session = makeLitSession(stubs);
  pb::VolumeSubscription volumes;
  volumes.set_session(session);
  volumes.set_format(pb::VOLUME_FORMAT_FLOAT);
  client::VolumeWatcher volumeWatcher(
      client, volumes, [&](const client::VolumeResult& result) { shown.add(result.header.result()); }, shown.hooks());
  pb::FrameSubscription frames;
  frames.set_session(session);
  frames.set_width(64);
  frames.set_height(48);
  *frames.mutable_camera()->mutable_camera() = camera({0, 0, 2}, {0, 0, 0});
  client::FrameWatcher frameWatcher(
      client, frames,
      [&](const client::FrameResult& result) {
        const std::lock_guard lock(shown.mutex);
        shown.newestFrame = std::max(shown.newestFrame, std::uint64_t(result.header.result().revision()));
      },
      shown.hooks());
  constexpr std::uint64_t kLit = 1;
  ASSERT_TRUE(eventually([&] { return shown.sawAll(kLit); })) << "both watch before anything moves";
  for (int move = 0; move < kMoves; ++move) {
    const std::uint64_t revision = apply(stubs, session, {moveTo("Lamp", {0.02 * move, 0.01 * move, 0.0})}).revision();
    ASSERT_TRUE(eventually([&] { return shown.sawAll(revision); })) << "revision " << revision;
  }
}

// Seen to fail without GlThread::recover().
TEST(ContextLoss, GoesUnnoticedByThoseWhoWatch) {
  Shown undisturbed;
  tell(server().address(), undisturbed);
  ServerProcess losing({}, "127.0.0.1:0", LOSING_PATH);
  Shown disturbed;
  tell(losing.address(), disturbed);
  EXPECT_EQ(disturbed.volumes, undisturbed.volumes) << "bit for bit";
  EXPECT_EQ(disturbed.epochs.size(), 1U);
  EXPECT_EQ(disturbed.broken, 0);
  EXPECT_THAT(losing.log(), testing::HasSubstr("the graphics context was lost"));
}

}  // namespace
}  // namespace lpv::rpc
