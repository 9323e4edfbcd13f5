// What a volume costs on the wire: a living room's windows and a television that moves at 30 results a second, by the
// real engine, in every coding. Bytes are payloads; times are CPU times of one core; errors are those that the coding
// adds, the largest of all results. Each subscriber acknowledges every result before the next. Numbers, not verdicts.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

#include "bench/codec_error.h"
#include "bench/codec_scene.h"
#include "wire/publish.h"
#include "wire/volume_codec.h"

namespace {

using namespace lpv;

constexpr double kRate = 30.0;  // results per second
constexpr std::size_t kPartBytes = wire::kMaxPayloadBytes - 16 * 1024;

struct Coding {
  const char* name;
  wire::Format format;
  wire::Compression compression;
  bool delta;
  int toleranceClass;
};

struct Cost {
  std::vector<double> bytes;
  std::vector<double> encodeMs;
  std::vector<double> decodeMs;
  bench::AddedError error;
};

double cpuMs() { return 1e3 * double(std::clock()) / CLOCKS_PER_SEC; }

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// A client's side: parts in, a volume out.
Volume receive(const wire::VolumeState& sent, const wire::EncodedVolume& encoded, wire::VolumeStatePtr* held) {
  wire::VolumeDecoder decoder(sent.shape, encoded.compression, *held);
  for (const wire::Part& part : encoded.parts) {
    if (!decoder.add(part.bricks, part.payload).ok()) std::abort();
  }
  const Expected<wire::VolumeStatePtr> state = decoder.finish(encoded.checksum);
  if (!state) std::abort();
  *held = *state;
  return wire::volumeFrom(**state);
}

void measure(const Coding& coding, const Volume& truth, wire::VolumeStatePtr* published, wire::VolumeStatePtr* held,
             Cost* cost) {
  const double start = cpuMs();
  const wire::VolumeStatePtr before = *published;
  *published = wire::publish(truth, coding.format, coding.toleranceClass, before.get());
  const bool relative = coding.delta && before && before->shape == (*published)->shape;
  const wire::EncodedVolume encoded =
      wire::encodeVolume(**published, relative ? before.get() : nullptr, coding.compression, kPartBytes);
  const double encodedAt = cpuMs();
  if (!relative) *held = nullptr;
  const Volume received = receive(**published, encoded, held);
  const double decodedAt = cpuMs();
  std::size_t bytes = 0;
  for (const wire::Part& part : encoded.parts) bytes += part.payload.size();
  cost->bytes.push_back(double(bytes));
  cost->encodeMs.push_back(encodedAt - start);
  cost->decodeMs.push_back(decodedAt - encodedAt);
  const bench::AddedError error = bench::addedError(truth, received);
  cost->error.irradiance = std::max(cost->error.irradiance, error.irradiance);
  cost->error.cell = std::max(cost->error.cell, error.cell);
  cost->error.fluence = std::max(cost->error.fluence, error.fluence);
}

/// The first result is a key frame for everybody: it is what a join costs, and is not counted among the deltas.
void run(const Coding& coding, const std::vector<VolumePtr>& volumes) {
  wire::VolumeStatePtr published;
  wire::VolumeStatePtr held;
  Cost first;
  Cost cost;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    measure(coding, *volumes[i], &published, &held, i == 0 && coding.delta ? &first : &cost);
  }
  double sum = 0.0;
  for (const double bytes : cost.bytes) sum += bytes;
  const double mean = sum / double(cost.bytes.size());
  std::printf("| %s | %.1f | %.2f | %.1f | %.1f | %.3f | %.2f | %.2f |\n", coding.name, mean / 1e3,
              mean * 8.0 * kRate / 1e6, median(cost.encodeMs), median(cost.decodeMs), 100.0 * cost.error.irradiance,
              100.0 * cost.error.cell, 100.0 * cost.error.fluence);
}

void printTable(const char* title, const std::vector<VolumePtr>& volumes, const std::vector<Coding>& codings) {
  std::printf(
      "\n%s\n\n| coding | kB per result | Mbit/s at 30/s | encode ms | decode ms | added L2 of irradiance %% | "
      "worst cell %% | its fluence %% |\n|---|---|---|---|---|---|---|---|\n",
      title);
  for (const Coding& coding : codings) run(coding, volumes);
}

}  // namespace

int main(int argc, char** argv) {
  int results = 40;
  double cells = 0.25;
  CLI::App app("Bytes, times and errors of every coding of a volume");
  app.add_option("--results", results)->capture_default_str();
  app.add_option("--cells", cells, "that the television moves between two results")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  using wire::Compression;
  using wire::Format;
  const std::vector<Coding> deltas{{"half, delta, zstd", Format::kHalf, Compression::kZstd, true, 0},
                                   {"half, delta, tolerance 1", Format::kHalf, Compression::kZstd, true, 1},
                                   {"half, delta, tolerance 2", Format::kHalf, Compression::kZstd, true, 2},
                                   {"half, delta, tolerance 3", Format::kHalf, Compression::kZstd, true, 3},
                                   {"compact, delta, tolerance 0", Format::kCompact, Compression::kZstd, true, 0},
                                   {"compact, delta, tolerance 1", Format::kCompact, Compression::kZstd, true, 1},
                                   {"compact, delta, tolerance 2", Format::kCompact, Compression::kZstd, true, 2},
                                   {"compact, delta, tolerance 3", Format::kCompact, Compression::kZstd, true, 3}};
  std::vector<Coding> all{{"half", Format::kHalf, Compression::kNone, false, 0},
                          {"half, zstd", Format::kHalf, Compression::kZstd, false, 0},
                          {"compact, key frames, tolerance 0", Format::kCompact, Compression::kZstd, false, 0},
                          {"compact, key frames, tolerance 3", Format::kCompact, Compression::kZstd, false, 3}};
  all.insert(all.end(), deltas.begin(), deltas.end());
  const std::vector<VolumePtr> moving = bench::movingTelevision(results, cells);
  const glm::ivec3 dims = moving[0]->grid.dims;
  std::printf("%dx%dx%d cells, %zu layer, %d results, television moves %.2f cells per result\n", dims.x, dims.y, dims.z,
              moving[0]->layers.size(), results, cells);
  printTable("Moving:", moving, all);
  printTable("Still:", bench::movingTelevision(results, 0.0), deltas);
  return 0;
}
