// The client's decoder of volumes and frames against a server that sends anything, and the codec against volumes of any
// content: what is published comes back bit for bit, however it is coded, and is as near the truth as its class says.
//
// Seen to find a brick that is not decoded relative to its base (VolumeDecoder::addPlanes).

#include <fuzzer/FuzzedDataProvider.h>

#include <cmath>

#include "assemble.h"
#include "fuzz/check.h"
#include "unit/wire/wire_rig.h"
#include "wire/compression.h"

namespace lpv::fuzz {
namespace {

namespace pb = lpv::v1;

/// Halves have 11 bits, whatever the tolerance.
constexpr double kHalfRounding = 1e-3;

/// Anything, or what COMPACT begins with: how many of the bytes say where zeros are, and some blocks of nothing else.
std::string bytesOf(FuzzedDataProvider& in) {
  static const std::string dark = std::string("\0", 1) + std::string(12, '\xff');
  std::string runs;
  for (int blocks = in.ConsumeIntegralInRange(-8, 8); blocks > 0; --blocks) runs += dark;
  if (runs.empty()) return in.ConsumeRandomLengthString(2000);
  const auto size = std::uint32_t(runs.size()) + in.ConsumeIntegralInRange<std::uint32_t>(0, 1);
  return std::string(reinterpret_cast<const char*>(&size), sizeof size) + runs + in.ConsumeRandomLengthString(2000);
}

int smallOrAny(FuzzedDataProvider& in, int low, int high) {
  return in.ConsumeIntegralInRange(0, 15) == 0 ? in.ConsumeIntegral<int>() : in.ConsumeIntegralInRange(low, high);
}

pb::VolumeHeader headerOf(FuzzedDataProvider& in) {
  pb::VolumeHeader header;
  header.mutable_result()->set_result_id(std::uint64_t(smallOrAny(in, 1, 1)));
  header.mutable_result()->set_checksum(in.ConsumeIntegral<std::uint64_t>());
  header.mutable_grid()->set_cell_size(double(smallOrAny(in, 1, 8)));
  header.mutable_grid()->mutable_dims()->set_x(smallOrAny(in, 1, 20));
  header.mutable_grid()->mutable_dims()->set_y(smallOrAny(in, 1, 9));
  header.mutable_grid()->mutable_dims()->set_z(smallOrAny(in, 1, 9));
  header.set_coefficients(smallOrAny(in, 4, 4));
  header.set_brick_edge(smallOrAny(in, 8, 8));
  header.set_format(pb::VolumeFormat(smallOrAny(in, 0, 4)));
  header.set_compression(pb::PayloadCompression(smallOrAny(in, 0, 2)));
  for (int layers = smallOrAny(in, 1, 3) % 20; layers > 0; --layers) {
    header.add_layers()->set_scale(double(smallOrAny(in, 1, 8)));
  }
  header.set_base_result_id(std::uint64_t(smallOrAny(in, 0, 0)));
  header.set_part_count(smallOrAny(in, 1, 3));
  return header;
}

/// Parts that are in order now and then.
void hostileVolume(FuzzedDataProvider& in) {
  client::VolumeAssembler assembler;
  int index = 0;
  bool zstd = false;
  while (in.remaining_bytes() > 0) {
    pb::VolumePart part;
    if (index == 0 || in.ConsumeBool()) {
      *part.mutable_header() = headerOf(in);
      index = 0;
      zstd = part.header().compression() == pb::PAYLOAD_COMPRESSION_ZSTD;
    }
    part.set_result_id(std::uint64_t(smallOrAny(in, 1, 1)));
    part.set_index(smallOrAny(in, index, index));
    ++index;
    for (int runs = in.ConsumeIntegralInRange(0, 3); runs > 0; --runs) {
      pb::BrickRun* run = part.add_bricks();
      run->set_first(smallOrAny(in, 0, 8));
      run->set_count(smallOrAny(in, 1, 4));
    }
    const std::string body = bytesOf(in);
    part.set_payload(zstd == (smallOrAny(in, 1, 1) == 1) ? wire::compress(body) : body);
    const auto result = assembler.add(part);
    if (!result) checkRefusal(result.status());
  }
}

void hostileFrame(FuzzedDataProvider& in) {
  client::FrameAssembler assembler;
  while (in.remaining_bytes() > 0) {
    pb::FramePart part;
    if (in.ConsumeBool()) {
      part.mutable_header()->set_size(smallOrAny(in, 0, 100));
      part.mutable_header()->set_part_count(smallOrAny(in, 1, 3));
    }
    part.set_index(smallOrAny(in, 0, 2));
    part.set_payload(in.ConsumeRandomLengthString(50));
    const auto result = assembler.add(part);
    if (!result) checkRefusal(result.status());
  }
}

/// Light as a field can have it: more from one side than from another, nowhere negative.
Volume anyVolume(FuzzedDataProvider& in, const glm::ivec3& dims, std::size_t layers) {
  Volume volume;
  volume.grid = Grid{{0.0, 0.0, 0.0}, 0.25, dims};
  const float magnitude = std::exp2(float(in.ConsumeIntegralInRange(-60, 60)));
  for (std::size_t layer = 0; layer < layers; ++layer) {
    VolumeLayer& out = volume.layers.emplace_back(VolumeLayer{"group" + std::to_string(layer), {}});
    for (std::size_t i = 0; i < volume.grid.cells() * 3; ++i) {
      const int stops = in.ConsumeIntegral<std::int8_t>() / 8;
      const float light = stops < 0 ? 0.0F : magnitude * std::exp2(-float(stops)) * (1.0F + float(i % 7) / 8.0F);
      out.coefficients.push_back(light);
      for (int m = 0; m < 3; ++m) out.coefficients.push_back(light * float(in.ConsumeIntegral<std::int8_t>()) / 128.0F);
    }
  }
  return volume;
}

/// Results of one chain, each coded relative to the one that the other end holds, through the codec's both ends.
class Chain {
 public:
  explicit Chain(FuzzedDataProvider& in)
      : format_(wire::Format(in.ConsumeIntegralInRange(0, 2))),
        class_(in.ConsumeIntegralInRange(0, wire::kToleranceClasses - 1)),
        compression_(in.ConsumeBool() ? wire::Compression::kZstd : wire::Compression::kNone),
        dims_(in.ConsumeIntegralInRange(1, 10), in.ConsumeIntegralInRange(1, 3), in.ConsumeIntegralInRange(1, 3)),
        layers_(std::size_t(in.ConsumeIntegralInRange(1, 2))) {}

  wire::EncodedVolume encodeNext(FuzzedDataProvider& in) {
    truth_ = anyVolume(in, dims_, layers_);
    published_ = wire::publish(truth_, format_, class_, published_.get());
    base_ = held_ && held_->shape == published_->shape ? held_ : nullptr;
    return wire::encodeVolume(*published_, base_.get(), compression_,
                              std::size_t(in.ConsumeIntegralInRange(1, 30'000)));
  }

  /// What arrived as it was sent is what was published, and near the truth.
  void deliver(const wire::EncodedVolume& encoded) {
    const Expected<wire::VolumeStatePtr> decoded = wire::decode(*published_, encoded, base_);
    check(decoded.ok(), "what was encoded can be decoded: " + decoded.status().message());
    check(wire::checksumOf(**decoded) == wire::checksumOf(*published_), "a volume comes back bit for bit");
    const double off = wire::furthest(truth_, wire::volumeFrom(**decoded));
    const double allowed = wire::toleranceOf(format_, class_) + (format_ == wire::Format::kHalf ? kHalfRounding : 0.0);
    check(off <= allowed, "a volume is within " + std::to_string(allowed) + " of the truth, is " + std::to_string(off));
    held_ = *decoded;
  }

  /// What arrived otherwise is refused, unless it says the same in other words.
  void deliverTampered(const wire::EncodedVolume& encoded) {
    const Expected<wire::VolumeStatePtr> decoded = wire::decode(*published_, encoded, base_);
    if (!decoded) return checkRefusal(decoded.status());
    check(wire::checksumOf(**decoded) == wire::checksumOf(*published_), "an accepted volume is the one published");
    wire::volumeFrom(**decoded);
  }

 private:
  const wire::Format format_;
  const int class_;
  const wire::Compression compression_;
  const glm::ivec3 dims_;
  const std::size_t layers_;
  Volume truth_;
  wire::VolumeStatePtr published_, held_, base_;
};

void roundTrips(FuzzedDataProvider& in) {
  Chain chain(in);
  for (int result = in.ConsumeIntegralInRange(1, 3); result > 0; --result) chain.deliver(chain.encodeNext(in));
}

/// Changes, removes, inserts or repeats a few bytes.
void tamper(FuzzedDataProvider& in, std::string& bytes) {
  const auto at = in.ConsumeIntegralInRange<std::size_t>(0, bytes.size());
  const std::size_t length = std::min(bytes.size() - at, in.ConsumeIntegralInRange<std::size_t>(0, 8));
  switch (in.ConsumeIntegralInRange(0, 3)) {
    case 0:
      bytes.replace(at, length, in.ConsumeBytesAsString(length));
      break;
    case 1:
      bytes.erase(at, in.ConsumeBool() ? length : std::string::npos);
      break;
    case 2:
      bytes.insert(at, in.ConsumeRandomLengthString(16));
      break;
    default:
      bytes.insert(at, bytes.substr(at, length));
  }
}

void tamper(FuzzedDataProvider& in, std::vector<wire::BrickRun>& bricks) {
  if (bricks.empty() || in.ConsumeIntegralInRange(0, 3) == 0) {
    bricks.push_back({smallOrAny(in, 0, 2), smallOrAny(in, 1, 2)});
    return;
  }
  wire::BrickRun& run = bricks[in.ConsumeIntegralInRange<std::size_t>(0, bricks.size() - 1)];
  int& number = in.ConsumeBool() ? run.first : run.count;
  number = int(unsigned(number) + unsigned(smallOrAny(in, -2, 2)));  // round the end
}

/// Beneath the compression: nothing that is changed there comes through it by chance.
void tamperContent(FuzzedDataProvider& in, wire::Compression compression, std::string& payload) {
  if (compression == wire::Compression::kNone || payload.empty()) return tamper(in, payload);
  Expected<std::string> content = wire::decompress(payload, wire::kMaxPayloadBytes);
  if (!content) return tamper(in, payload);  // changed before
  tamper(in, *content);
  payload = wire::compress(*content);
}

/// Volumes as a server writes them, changed here and there: what only all but well-formed parts reach.
void tamperedVolumes(FuzzedDataProvider& in) {
  Chain chain(in);
  for (int result = in.ConsumeIntegralInRange(0, 1); result > 0; --result) chain.deliver(chain.encodeNext(in));
  wire::EncodedVolume encoded = chain.encodeNext(in);
  for (int changes = in.ConsumeIntegralInRange(1, 4); changes > 0; --changes) {
    wire::Part& part = encoded.parts[in.ConsumeIntegralInRange<std::size_t>(0, encoded.parts.size() - 1)];
    switch (in.ConsumeIntegralInRange(0, 4)) {
      case 0:
        tamper(in, part.bricks);
        break;
      case 1:
        tamper(in, part.payload);
        break;
      case 2:
        encoded.parts.push_back(wire::Part(part));
        break;
      default:
        tamperContent(in, encoded.compression, part.payload);
    }
  }
  chain.deliverTampered(encoded);
}

}  // namespace
}  // namespace lpv::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider in(data, size);
  switch (in.ConsumeIntegralInRange(0, 5)) {
    case 0:
      lpv::fuzz::hostileFrame(in);
      break;
    case 1:
      lpv::fuzz::roundTrips(in);
      break;
    case 2:
    case 3:
      lpv::fuzz::tamperedVolumes(in);
      break;
    default:
      lpv::fuzz::hostileVolume(in);
  }
  return 0;
}
