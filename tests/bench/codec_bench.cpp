// What a volume costs on the wire: a living room's windows and a television that moves at 30 results a second, by the
// real engine, in every coding. Bytes are payloads; times are CPU times of one core; errors are those that the coding
// adds, the largest of all results. Each subscriber acknowledges every result before the next. Numbers, not verdicts.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "bench/codec_error.h"
#include "bench/codec_scene.h"
#include "bench/codec_zfp.h"
#include "bench/core_scene.h"
#include "bench/rows.h"
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

  void add(const bench::AddedError& more) {
    error.irradiance = std::max(error.irradiance, more.irradiance);
    error.cell = std::max(error.cell, more.cell);
    error.fluence = std::max(error.fluence, more.fluence);
  }
};

double cpuMs() { return 1e3 * double(std::clock()) / CLOCKS_PER_SEC; }

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
  cost->add(bench::addedError(truth, received));
}

bench::Row rowOf(const std::string& name, const std::string& coding, const Cost& cost) {
  double sum = 0.0;
  for (const double bytes : cost.bytes) sum += bytes;
  const double mean = sum / double(cost.bytes.size());
  return {name,
          "coding",
          {{"coding", coding}},
          {{"bytes", mean},
           {"mbit_per_s_at_30", mean * 8.0 * kRate / 1e6},
           {"encode_ms", bench::medianOf(cost.encodeMs)},
           {"decode_ms", bench::medianOf(cost.decodeMs)},
           {"irradiance_l2", cost.error.irradiance},
           {"worst_cell", cost.error.cell},
           {"worst_fluence", cost.error.fluence}}};
}

/// The first result is a key frame for everybody: it is what a join costs, and is not counted among the deltas.
void run(const std::string& name, const Coding& coding, const std::vector<VolumePtr>& volumes, bench::Rows* rows) {
  wire::VolumeStatePtr published;
  wire::VolumeStatePtr held;
  Cost first;
  Cost cost;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    measure(coding, *volumes[i], &published, &held, i == 0 && coding.delta ? &first : &cost);
  }
  rows->add(rowOf(name, coding.name, cost));
}

#ifdef LPV_ZFP
/// Key frames all: zfp knows of no result before.
void runZfp(const std::string& name, double tolerance, const std::vector<VolumePtr>& volumes, bench::Rows* rows) {
  Cost cost;
  for (const VolumePtr& volume : volumes) {
    const bench::ZfpVolume through = bench::throughZfp(*volume, tolerance);
    cost.bytes.push_back(double(through.bytes));
    cost.encodeMs.push_back(through.encodeMs);
    cost.decodeMs.push_back(through.decodeMs);
    cost.add(bench::addedError(*volume, through.decoded));
  }
  char coding[64];
  std::snprintf(coding, sizeof coding, "zfp, key frames, %g of the largest", tolerance);
  rows->add(rowOf(name, coding, cost));
}
#endif

}  // namespace

int main(int argc, char** argv) {
  int results = 40;
  double cells = 0.25;
  std::string rowsFile;
  CLI::App app("Bytes, times and errors of every coding of a volume");
  app.add_option("--results", results)->capture_default_str();
  app.add_option("--cells", cells, "that the television moves between two results")->capture_default_str();
  app.add_option("--rows", rowsFile, bench::kRowsHelp);
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
  const std::vector<VolumePtr> still = bench::movingTelevision(results, 0.0);
  bench::Rows rows(rowsFile, bench::engine().device().name);
  for (const Coding& coding : all) run("moving", coding, moving, &rows);
#ifdef LPV_ZFP
  for (const double tolerance : {1e-4, 1e-3, 4e-3, 1e-2, 3e-2}) runZfp("moving", tolerance, moving, &rows);
#endif
  for (const Coding& coding : deltas) run("still", coding, still, &rows);
  return 0;
}
