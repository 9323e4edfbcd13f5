// A server that breaks its word: the client library notices, and asks for a whole volume.

#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <mutex>

#include "lpv/convert.h"
#include "lpv/watch.h"
#include "rpc/support/rpc.h"
#include "wire/publish.h"
#include "wire/volume_codec.h"

namespace lpv::rpc {
namespace {

/// What is wrong with the second result.
enum class Fault { kChecksum, kUnknownBase, kPayload };

Volume volumeOf(int step) {
  Volume volume;
  volume.grid = Grid{{0.0, 0.0, 0.0}, 0.5, {9, 8, 8}};
  std::vector<float>& out = volume.layers.emplace_back(VolumeLayer{"", {}}).coefficients;
  for (std::size_t i = 0; i < volume.grid.cells() * 12; ++i) {
    out.push_back(i % 4 == 0 ? 1.0F + 0.1F * float(step) + 0.001F * float(i % 97) : 0.2F);
  }
  return volume;
}

/// Streams a key frame, a broken delta, and then whatever the client asks for.
class BrokenServer final : public pb::ResultService::Service {
 public:
  explicit BrokenServer(Fault fault) : fault_(fault) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  ~BrokenServer() override { server_->Shutdown(std::chrono::system_clock::now()); }

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  /// The updates that came, in order.
  std::vector<pb::SubscriberUpdate> updates() const {
    const std::lock_guard lock(mutex_);
    return updates_;
  }

  grpc::Status StreamVolume(
      grpc::ServerContext*,
      grpc::ServerReaderWriter<pb::StreamVolumeResponse, pb::StreamVolumeRequest>* stream) override {
    pb::StreamVolumeRequest request;
    if (!stream->Read(&request)) return {};
    wire::VolumeStatePtr base;
    for (std::uint64_t id = 1; id <= 4; ++id) {
      const auto state = wire::publish(volumeOf(int(id)), wire::Format::kCompact, 0, base.get());
      const bool key = id == 1 || request.update().request_key_frame();
      stream->Write(message(id, *state, key ? nullptr : base.get()));
      base = state;
      if (!stream->Read(&request)) return {};
      const std::lock_guard lock(mutex_);
      updates_.push_back(request.update());
    }
    while (stream->Read(&request)) {
    }
    return {};
  }

 private:
  pb::StreamVolumeResponse message(std::uint64_t id, const wire::VolumeState& state,
                                   const wire::VolumeState* base) const {
    const wire::EncodedVolume encoded =
        wire::encodeVolume(state, base, wire::Compression::kZstd, wire::kMaxPayloadBytes);
    pb::StreamVolumeResponse response;
    pb::VolumePart* part = response.mutable_event()->mutable_part();
    pb::VolumeHeader* header = part->mutable_header();
    const bool broken = id == 2;
    header->mutable_result()->set_epoch(1);
    header->mutable_result()->set_revision(id);
    header->mutable_result()->set_result_id(id);
    header->mutable_result()->set_checksum(encoded.checksum + (broken && fault_ == Fault::kChecksum ? 1 : 0));
    pb::Dims* dims = header->mutable_grid()->mutable_dims();
    dims->set_x(9);
    dims->set_y(8);
    dims->set_z(8);
    header->mutable_grid()->set_cell_size(0.5);
    header->set_coefficients(4);
    header->set_format(pb::VOLUME_FORMAT_COMPACT);
    header->set_compression(pb::PAYLOAD_COMPRESSION_ZSTD);
    header->add_layers()->set_scale(encoded.scales[0]);
    if (base != nullptr) header->set_base_result_id(broken && fault_ == Fault::kUnknownBase ? 77 : id - 1);
    header->set_brick_edge(8);
    header->set_part_count(1);
    part->set_result_id(id);
    for (const wire::BrickRun& run : encoded.parts.at(0).bricks) {
      part->add_bricks()->set_first(run.first);
      part->mutable_bricks()->rbegin()->set_count(run.count);
    }
    part->set_payload(encoded.parts[0].payload + (broken && fault_ == Fault::kPayload ? "x" : ""));
    return response;
  }

  Fault fault_;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
  mutable std::mutex mutex_;
  std::vector<pb::SubscriberUpdate> updates_;
};

TEST(Recovery, AFaultyResultIsNotShownAndAKeyFrameIsAskedFor) {
  for (const Fault fault : {Fault::kChecksum, Fault::kUnknownBase, Fault::kPayload}) {
    BrokenServer server(fault);
    client::Client client = clientOf(server.address());
    std::mutex mutex;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> shown;  // (result, base)
    client::VolumeWatcher watcher(client, {}, [&](const client::VolumeResult& result) {
      const std::lock_guard lock(mutex);
      shown.emplace_back(result.header.result().result_id(), result.header.base_result_id());
    });
    ASSERT_TRUE(eventually([&] { return server.updates().size() == 4; })) << int(fault);
    const auto updates = server.updates();
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(updates[i].acknowledge().result_id(), i + 1);
      EXPECT_EQ(updates[i].request_key_frame(), i == 1);
    }
    watcher.stop();
    using Shown = std::pair<std::uint64_t, std::uint64_t>;
    EXPECT_EQ(shown, (std::vector<Shown>{{1, 0}, {3, 0}, {4, 3}}));
    EXPECT_EQ(watcher.stats().faults, 1U);
  }
}

}  // namespace
}  // namespace lpv::rpc
