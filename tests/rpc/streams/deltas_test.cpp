// Volumes relative to others: what readers hold, what they are sent, and how often it is encoded.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <tuple>

#include "lpv/watch.h"
#include "rpc/streams/seen.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using VolumeStream = grpc::ClientReaderWriter<pb::StreamVolumeRequest, pb::StreamVolumeResponse>;

/// A reader that acknowledges when it is told to.
class Reader {
 public:
  Reader(Stubs& stubs, const pb::VolumeSubscription& subscription) : stream_(stubs.result->StreamVolume(call_)) {
    pb::StreamVolumeRequest request;
    *request.mutable_subscription() = subscription;
    stream_->Write(request);
  }

  /// The next result's header.
  pb::VolumeHeader next() {
    EXPECT_TRUE(seen_.next(*stream_));
    return seen_.header;
  }
  void acknowledge() {
    pb::StreamVolumeRequest request;
    request.mutable_update()->mutable_acknowledge()->set_result_id(seen_.result.result_id());
    stream_->Write(request);
  }
  void askForKeyFrame() {
    pb::StreamVolumeRequest request;
    request.mutable_update()->set_request_key_frame(true);
    stream_->Write(request);
  }
  VolumeStream& stream() { return *stream_; }

 private:
  Call call_;
  std::unique_ptr<VolumeStream> stream_;
  Seen<pb::StreamVolumeResponse> seen_;
};

class Deltas : public ::testing::Test {
 protected:
  pb::VolumeSubscription subscription(pb::VolumeFormat format, int toleranceClass = 0) const {
    pb::VolumeSubscription out;
    out.set_session(session_);
    out.set_format(format);
    out.set_tolerance_class(toleranceClass);
    return out;
  }
  /// The lamp a little further; the revision.
  std::uint64_t move() { return apply(stubs_, session_, {moveTo("Lamp", {0.02 * ++steps_, 0.1, 0.0})}).revision(); }

  Volume truth() {
    pb::GetVolumeRequest request;
    request.set_session(session_);
    request.set_format(pb::VOLUME_FORMAT_FLOAT);
    Expected<client::VolumeResult> result = client_.volume(request);
    EXPECT_TRUE(result.ok()) << result.status().message();
    return std::move(result->volume);
  }
  std::int64_t encoded() {
    pb::GetStatsResponse stats;
    EXPECT_THAT(stubs_.server->GetStats(Call(), pb::GetStatsRequest(), &stats), IsOk());
    return stats.volumes_encoded();
  }

  Stubs stubs_{server().address()};
  client::Client client_ = clientOf(server().address());
  std::string session_ = makeLitSession(stubs_, 20);
  int steps_ = 0;
};

/// Largest difference of a coefficient, relative to its cell's and colour's own L00.
double furthest(const Volume& truth, const Volume& held) {
  double worst = 0.0;
  const std::vector<float>& a = truth.layers.at(0).coefficients;
  const std::vector<float>& b = held.layers.at(0).coefficients;
  const float dark = 1e-5F * *std::max_element(a.begin(), a.end());
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, double(std::abs(a[i] - b[i]) / std::max(a[i / 4 * 4], dark)));
  }
  return worst;
}

/// The cells of a volume that has one more on each side.
Volume innerOf(const Volume& guarded) {
  Volume inner;
  std::vector<float>& out = inner.layers.emplace_back().coefficients;
  const glm::ivec3 dims = guarded.grid.dims;
  for (int z = 1; z + 1 < dims.z; ++z) {
    for (int y = 1; y + 1 < dims.y; ++y) {
      const float* row = &guarded.layers.at(0).coefficients[guarded.grid.index({1, y, z}) * 12];
      out.insert(out.end(), row, row + std::size_t(dims.x - 2) * 12);
    }
  }
  return inner;
}

// One reader with guard cells and one without, and calls of both kinds. With guard cells a volume is that of a session
// whose bounds are a cell further out. Broken by: a guard that is zero, or clamped; bricks of the grid without it; one
// chain of bases for both; a reader without that is sent the other's.
TEST_F(Deltas, GuardCellsContinueTheVolume) {
  pb::SessionSettings larger = settings(22);
  *larger.mutable_grid()->mutable_bounds()->mutable_min() = vec3(-1.1, -1.1, -1.1);
  *larger.mutable_grid()->mutable_bounds()->mutable_max() = vec3(1.1, 1.1, 1.1);
  const std::string around = makeSession(stubs_, larger);
  apply(stubs_, around, {client::createLight(light("Lamp"))});
  std::mutex mutex;
  client::VolumeResult plain, guarded;
  const auto keep = [&mutex](client::VolumeResult& out) {
    return [&mutex, &out](client::VolumeResult result) {
      const std::lock_guard lock(mutex);
      out = std::move(result);
    };
  };
  pb::VolumeSubscription wanted = subscription(pb::VOLUME_FORMAT_FLOAT);
  client::VolumeWatcher without(client_, wanted, keep(plain));
  wanted.set_guard_cells(1);
  client::VolumeWatcher with(client_, wanted, keep(guarded));
  const auto hasGuard = [&] {
    const std::lock_guard lock(mutex);
    return guarded.header.guard_cells() == 1;
  };
  ASSERT_TRUE(eventually(hasGuard));  // what is made before is of blocks of cells that begin elsewhere
  for (int i = 0; i < 3; ++i) {
    const std::uint64_t revision = move();
    apply(stubs_, around, {moveTo("Lamp", {0.02 * steps_, 0.1, 0.0})});
    const auto shows = [&](const client::VolumeResult& result) {
      const std::lock_guard lock(mutex);
      return result.header.result().revision() == revision;
    };
    ASSERT_TRUE(eventually([&] { return shows(plain) && shows(guarded); }));
    pb::GetVolumeRequest request;
    request.set_session(around);
    request.set_format(pb::VOLUME_FORMAT_FLOAT);
    const Expected<client::VolumeResult> outer = client_.volume(request);
    ASSERT_TRUE(outer.ok()) << outer.status().message();
    request.set_session(session_);
    request.set_guard_cells(1);
    const Expected<client::VolumeResult> called = client_.volume(request);
    ASSERT_TRUE(called.ok()) << called.status().message();
    const std::lock_guard lock(mutex);
    EXPECT_EQ(plain.header.guard_cells(), 0);
    EXPECT_EQ(guarded.header.guard_cells(), 1);
    EXPECT_EQ(guarded.header.grid().dims().x(), 20);
    EXPECT_EQ(guarded.volume.grid.dims, glm::ivec3(22));
    EXPECT_EQ(plain.volume.grid.dims, glm::ivec3(20));
    EXPECT_EQ(innerOf(guarded.volume).layers[0].coefficients, plain.volume.layers.at(0).coefficients);
    EXPECT_EQ(called->volume.layers.at(0).coefficients, guarded.volume.layers.at(0).coefficients);
    EXPECT_LE(furthest(outer->volume, guarded.volume), 1e-4);
  }
  pb::GetVolumeRequest request;
  request.set_session(session_);
  request.set_guard_cells(2);
  EXPECT_EQ(client_.volume(request).status().code(), Code::kInvalidArgument);
}

// Broken by: a volume made without guard cells that is kept for those who ask for them; the server ended then.
TEST_F(Deltas, GuardCellsComeWithVolumesThatWereThereWithout) {
  for (const pb::Transport transport : {pb::TRANSPORT_PROPAGATE, pb::TRANSPORT_GATHER, pb::TRANSPORT_DIRECT}) {
    pb::SessionSettings wanted = settings(8);
    wanted.set_transport(transport);
    const std::string session = makeSession(stubs_, wanted);
    apply(stubs_, session, {client::createLight(light("Lamp")), client::createSurface(surface("Wall", quad(2.0F)))});
    for (const pb::VolumeStage stage : {pb::VOLUME_STAGE_INJECTED, pb::VOLUME_STAGE_TRANSPORTED}) {
      pb::GetVolumeRequest request;
      request.set_session(session);
      request.set_stage(stage);
      ASSERT_TRUE(client_.volume(request).ok());
      request.set_guard_cells(1);
      const Expected<client::VolumeResult> guarded = client_.volume(request);
      ASSERT_TRUE(guarded.ok()) << guarded.status().message();
      EXPECT_EQ(guarded->volume.grid.dims, glm::ivec3(10));
    }
  }
}

/// Follows the lamp with the library until the newest revision is there; every result's checksum is verified.
TEST_F(Deltas, TheLibraryHoldsWhatTheServerMade) {
  using Coding = std::tuple<pb::VolumeFormat, int, double>;
  for (const auto& [format, toleranceClass, bound] :
       {Coding{pb::VOLUME_FORMAT_HALF_FLOAT, 0, 1e-3}, Coding{pb::VOLUME_FORMAT_FLOAT, 0, 0.0},
        Coding{pb::VOLUME_FORMAT_COMPACT, 0, 0.018}, Coding{pb::VOLUME_FORMAT_COMPACT, 2, 0.07},
        Coding{pb::VOLUME_FORMAT_HALF_FLOAT, 3, 0.14}}) {
    std::mutex mutex;
    client::VolumeResult last;
    std::size_t deltas = 0;
    client::VolumeWatcher watcher(client_, subscription(format, toleranceClass), [&](client::VolumeResult result) {
      const std::lock_guard lock(mutex);
      deltas += result.header.base_result_id() != 0 ? 1 : 0;
      last = std::move(result);
    });
    const auto shows = [&](std::uint64_t revision) {
      const std::lock_guard lock(mutex);
      return last.header.result().revision() == revision;
    };
    for (int i = 0; i < 6; ++i) {
      const std::uint64_t revision = move();
      ASSERT_TRUE(eventually([&] { return shows(revision); }));
    }
    watcher.stop();
    EXPECT_EQ(watcher.stats().faults, 0U);
    EXPECT_GE(deltas, 5U);
    EXPECT_LE(furthest(truth(), last.volume), bound) << pb::VolumeFormat_Name(format) << " " << toleranceClass;
  }
}

/// Broken on purpose: with a chain per reader, or without the list of what was made, the counter is above the pairs.
TEST_F(Deltas, OneEncodingServesAllWhoHoldTheSameBase) {
  const std::int64_t before = encoded();
  std::vector<std::unique_ptr<Reader>> readers;
  for (int i = 0; i < 5; ++i) {
    readers.push_back(std::make_unique<Reader>(
        stubs_, subscription(i < 3 ? pb::VOLUME_FORMAT_HALF_FLOAT : pb::VOLUME_FORMAT_COMPACT)));
  }
  using Pair = std::tuple<int, std::uint64_t, std::uint64_t>;
  std::set<Pair> pairs;
  std::size_t results = 0;
  std::size_t deltas = 0;
  constexpr int kRounds = 9;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < readers.size(); ++i) {
      if (i == 2 && round % 3 != 0) continue;  // has no credit: acknowledges every third round only
      const pb::VolumeHeader header = readers[i]->next();
      pairs.insert({int(header.format()), header.result().result_id(), header.base_result_id()});
      ++results;
      deltas += header.base_result_id() != 0 ? 1 : 0;
    }
    if (round == kRounds - 1) break;  // what nobody reads would be encoded too
    for (std::size_t i = 0; i < readers.size(); ++i) {
      if (i != 2 || round % 3 == 2) readers[i]->acknowledge();
    }
    move();
  }
  EXPECT_LE(encoded() - before, std::int64_t(pairs.size()));
  EXPECT_LT(pairs.size(), results);
  EXPECT_GE(deltas, results - 2 * readers.size());
}

TEST_F(Deltas, ARequestedKeyFrameComesAndSoItIsForABaseThatIsGone) {
  Reader reader(stubs_, subscription(pb::VOLUME_FORMAT_HALF_FLOAT));
  EXPECT_EQ(reader.next().base_result_id(), 0U);
  reader.acknowledge();
  move();
  const pb::VolumeHeader delta = reader.next();
  EXPECT_LT(delta.base_result_id(), delta.result().result_id());
  EXPECT_NE(delta.base_result_id(), 0U);
  reader.askForKeyFrame();
  reader.acknowledge();  // of what is lost: no base
  EXPECT_EQ(reader.next().base_result_id(), 0U);
  reader.acknowledge();
  move();
  EXPECT_NE(reader.next().base_result_id(), 0U);
  // While it holds its credit back, another reader sees ten more results.
  Reader other(stubs_, subscription(pb::VOLUME_FORMAT_HALF_FLOAT));
  for (int i = 0; i < 10; ++i) {
    other.next();
    other.acknowledge();
    move();
  }
  other.next();
  reader.acknowledge();
  EXPECT_EQ(reader.next().base_result_id(), 0U);
}

TEST_F(Deltas, NothingIsSentOfAVolumeThatDidNotChange) {
  Reader reader(stubs_, subscription(pb::VOLUME_FORMAT_COMPACT));
  reader.next();
  reader.acknowledge();
  pb::Operation camera;
  *camera.mutable_put_camera() = rpc::camera({0, 0, 2}, {0, 0, 0});
  camera.mutable_put_camera()->set_name("Eye");
  apply(stubs_, session_, {camera});
  pb::StreamVolumeResponse response;
  while (reader.stream().Read(&response) && !response.event().has_part()) {
  }
  EXPECT_NE(response.event().part().header().base_result_id(), 0U);
  EXPECT_EQ(response.event().part().header().part_count(), 1);
  EXPECT_EQ(response.event().part().bricks_size(), 0);
  EXPECT_EQ(response.event().part().payload().size(), 0U);
}

TEST_F(Deltas, ARegionIsItsBricksOnly) {
  pb::VolumeSubscription wanted = subscription(pb::VOLUME_FORMAT_FLOAT);
  *wanted.mutable_region()->mutable_min() = vec3(0.7, 0.7, 0.7);
  *wanted.mutable_region()->mutable_max() = vec3(1, 1, 1);
  std::mutex mutex;
  client::VolumeResult last;
  client::VolumeWatcher watcher(client_, wanted, [&](client::VolumeResult result) {
    const std::lock_guard lock(mutex);
    last = std::move(result);
  });
  std::uint64_t revision = 1;
  for (int i = 0; i < 3; ++i, revision = move()) {
    ASSERT_TRUE(eventually([&] {
      const std::lock_guard lock(mutex);
      return last.header.result().revision() == revision;
    }));
    EXPECT_GT(last.bytes, 0U);
    EXPECT_LT(last.bytes, 4U * 4U * 4U * 48U + 100U);  // the outermost brick of 20 cells
  }
  watcher.stop();
  EXPECT_EQ(watcher.stats().faults, 0U);
  const std::vector<float>& held = last.volume.layers.at(0).coefficients;
  const Grid& grid = last.volume.grid;
  EXPECT_GT(held[grid.index({16, 16, 16}) * 12], 0.0F);
  EXPECT_EQ(held[grid.index({15, 16, 16}) * 12], 0.0F);
  EXPECT_EQ(held[grid.index({16, 16, 15}) * 12], 0.0F);
}

TEST_F(Deltas, LargeVolumesTravelInPartsBelowTheLimit) {
  session_ = makeLitSession(stubs_, 48);
  for (const pb::PayloadCompression compression : {pb::PAYLOAD_COMPRESSION_NONE, pb::PAYLOAD_COMPRESSION_ZSTD}) {
    pb::VolumeSubscription wanted = subscription(pb::VOLUME_FORMAT_FLOAT);
    wanted.set_compression(compression);
    Reader reader(stubs_, wanted);
    for (const bool delta : {false, true}) {
      pb::VolumeHeader header;
      pb::StreamVolumeResponse response;
      do {
        ASSERT_TRUE(reader.stream().Read(&response));
        EXPECT_LE(response.ByteSizeLong(), std::size_t(kMiB));
        if (response.event().part().has_header()) header = response.event().part().header();
      } while (!response.event().has_part() || response.event().part().index() + 1 < header.part_count());
      EXPECT_GE(header.part_count(), delta ? 3 : 5);  // behind the lamp it is dark: no delta
      EXPECT_EQ(header.compression(), compression);
      EXPECT_EQ(header.base_result_id() != 0, delta);
      pb::StreamVolumeRequest request;
      request.mutable_update()->mutable_acknowledge()->set_result_id(header.result().result_id());
      reader.stream().Write(request);
      move();
    }
  }
}

TEST_F(Deltas, ACompactVolumeIsWithinItsToleranceInASingleAnswerToo) {
  pb::GetVolumeRequest request;
  request.set_session(session_);
  request.set_format(pb::VOLUME_FORMAT_COMPACT);
  const Expected<client::VolumeResult> result = client_.volume(request);
  ASSERT_TRUE(result.ok()) << result.status().message();
  EXPECT_EQ(result->header.compression(), pb::PAYLOAD_COMPRESSION_ZSTD);
  EXPECT_LE(furthest(truth(), result->volume), 0.018);
  EXPECT_LT(result->bytes * 5, result->volume.grid.cells() * 24);
  request.set_compression(pb::PAYLOAD_COMPRESSION_NONE);
  const Expected<client::VolumeResult> plain = client_.volume(request);
  ASSERT_TRUE(plain.ok()) << plain.status().message();
  EXPECT_EQ(plain->volume.layers[0].coefficients, result->volume.layers[0].coefficients);
  EXPECT_GT(plain->bytes, result->bytes);
}

}  // namespace
}  // namespace lpv::rpc
