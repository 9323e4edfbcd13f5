// Many readers of one session at several speeds: what is encoded once for all.

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <set>
#include <thread>
#include <tuple>

#include "rpc/streams/seen.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

/// What has to be encoded: a format, a result, what it is relative to.
using Encoding = std::tuple<pb::VolumeFormat, std::uint64_t, std::uint64_t>;

/// What all readers have got together.
class Got {
 public:
  void add(pb::VolumeFormat format, const pb::VolumeHeader& header) {
    const std::lock_guard lock(mutex_);
    encodings_.emplace(format, header.result().result_id(), header.base_result_id());
    ++results_;
  }
  std::size_t encodings() const {
    const std::lock_guard lock(mutex_);
    return encodings_.size();
  }
  std::int64_t results() const { return results_; }

 private:
  mutable std::mutex mutex_;
  std::set<Encoding> encodings_;
  std::atomic<std::int64_t> results_{0};
};

class FanOut : public ::testing::Test {
 protected:
  /// Reads and acknowledges until the stream is cancelled.
  void read(grpc::ClientContext* context, pb::VolumeFormat format, double maxRate) {
    const auto stream = stubs_.result->StreamVolume(context);
    pb::StreamVolumeRequest request;
    request.mutable_subscription()->set_session(session_);
    request.mutable_subscription()->set_format(format);
    request.mutable_subscription()->set_max_rate(maxRate);
    stream->Write(request);
    Seen<pb::StreamVolumeResponse> seen;
    while (seen.next(*stream)) {
      got_.add(format, seen.header);
      request.mutable_update()->mutable_acknowledge()->set_result_id(seen.result.result_id());
      stream->Write(request);
    }
    (void)stream->Finish();
  }
  pb::GetStatsResponse stats() {
    pb::GetStatsResponse response;
    EXPECT_THAT(stubs_.server->GetStats(Call(), pb::GetStatsRequest(), &response), IsOk());
    return response;
  }

  Stubs stubs_{server().address()};
  std::string session_ = makeLitSession(stubs_, 16);
  Got got_;
};

// The light moves on when everything that was sent has come: nothing of it depends on how fast this machine is. Seen to
// fail without the list of what was made.
TEST_F(FanOut, EncodesOncePerFormatAndBaseForFiftyReadersAtThreeSpeeds) {
  constexpr int kReaders = 50;
  constexpr int kMoves = 40;
  const double speeds[] = {0.0, 10.0, 3.0};  // a second; 0: as fast as ticks come
  const pb::GetStatsResponse before = stats();
  std::vector<std::unique_ptr<Call>> calls;
  std::vector<std::thread> readers;
  for (int i = 0; i < kReaders; ++i) {
    calls.push_back(std::make_unique<Call>(std::chrono::seconds(250)));
    readers.emplace_back([this, context = static_cast<grpc::ClientContext*>(*calls.back()), rate = speeds[i % 3],
                          format = i % 2 == 0 ? pb::VOLUME_FORMAT_COMPACT : pb::VOLUME_FORMAT_HALF_FLOAT] {
      read(context, format, rate);
    });
  }
  const auto allCame = [&] { return stats().results_sent() - before.results_sent() == got_.results(); };
  EXPECT_TRUE(eventually([&] { return got_.results() == kReaders; })) << "a first result for everybody";
  for (int i = 1; i <= kMoves; ++i) {
    const std::int64_t had = got_.results();
    apply(stubs_, session_, {moveTo("Lamp", {0.02 * i, 0.1, 0.0})});
    ASSERT_TRUE(eventually([&] { return got_.results() > had && allCame(); }));
  }
  const pb::GetStatsResponse after = stats();
  const std::int64_t encoded = after.volumes_encoded() - before.volumes_encoded();
  const std::size_t different = got_.encodings();
  for (const auto& call : calls) (*call)->TryCancel();
  for (std::thread& reader : readers) reader.join();
  EXPECT_LE(encoded, std::int64_t(different));
  EXPECT_GE(got_.results(), kReaders + kMoves * (kReaders / 3)) << "who wants every tick got every move";
  std::cout << got_.results() << " results to " << kReaders << " readers in " << after.ticks() - before.ticks()
            << " ticks: " << encoded << " encodings, " << different << " pairs of base and target\n";
}

}  // namespace
}  // namespace lpv::rpc
