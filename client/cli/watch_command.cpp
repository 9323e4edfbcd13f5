// watch: follows a stream of frames or volumes and prints rate, age, size and stage times.

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <condition_variable>
#include <cstdio>
#include <iostream>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "command.h"
#include "interrupt.h"
#include "lpv/watch.h"
#include "output.h"
#include "scene_flags.h"
#include "values.h"

namespace lpv::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct WatchOptions {
  std::string id;
  bool frames = false;
  bool volume = false;
  double seconds = 0.0;
  double rate = 0.0;
  double adapt = 0.0;
  bool sharpen = false;
  std::optional<v1::VolumeFormat> format;
  std::optional<std::vector<double>> region;
  int tolerance = 0;
  FrameFlags frame;
};

/// Seconds since the server finished the result; needs synchronised clocks.
double ageOf(const v1::ResultInfo& info) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return double(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count() - info.server_time_ns()) * 1e-9;
}

std::string fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, value);
  return text;
}

/// Counts results. With --json prints each, otherwise one line per second.
class Report {
 public:
  Report(bool json, bool sharpens)
      : json_(json), sharpens_(sharpens), terminal_(isatty(STDOUT_FILENO) != 0), began_(Clock::now()) {}

  void add(const v1::ResultInfo& info, std::size_t bytes, bool sharp = false) {
    const std::lock_guard lock(mutex_);
    ages_.push_back(ageOf(info));
    bytes_ += bytes;
    ++results_;
    last_ = info;
    lastSharp_ = sharp;
    if (json_) print(jsonLine(info, bytes, ages_.back(), sharp));
  }

  void end(const Status& status) {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    status_ = status;
    changed_.notify_all();
  }

  /// True once the stream has ended.
  bool wait(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, time, [this] { return ended_; });
  }

  /// Whether nothing has come since the last line, but something before it: the revision that was seen last then.
  std::optional<std::uint64_t> silentSince() const {
    const std::lock_guard lock(mutex_);
    if (results_ > 0 || last_.revision() == 0) return std::nullopt;
    return last_.revision();
  }

  /// Prints one line about the last interval. `still`: the scene has not changed since what was seen last; that is said
  /// once, until something comes.
  void second(bool still) {
    const std::lock_guard lock(mutex_);
    const bool said = std::exchange(still_, still);
    if (still && said) return;
    if (still && json_) {
      note(stillLine());
      return;
    }
    const double seconds = std::chrono::duration<double>(Clock::now() - lineBegan_).count();
    const std::string line = still ? stillLine() : summaryLine(seconds);
    results_ = 0;
    bytes_ = 0;
    ages_.clear();
    lineBegan_ = Clock::now();
    if (json_) return;
    if (terminal_) {
      std::cout << "\r" << visible(line) << "\033[K" << std::flush;
    } else {
      print(line);
    }
  }

  Status finish(const client::WatchStats& stats) {
    const std::lock_guard lock(mutex_);
    const double seconds = std::chrono::duration<double>(Clock::now() - began_).count();
    if (!json_) {
      if (terminal_) print("");
      print(std::to_string(stats.results) + " results in " + fixed(seconds, 1) + " s, " +
            fixed(double(stats.results) / seconds, 1) + " /s, " + fixed(double(stats.bytes) / 1e6, 2) + " MB, " +
            std::to_string(stats.discarded) + " discarded, " + std::to_string(stats.faults) + " faulty, " +
            std::to_string(stats.reopened) + " times reconnected");
    }
    if (ended_ && !interrupted()) return status_;
    if (stats.results == 0 && !interrupted()) {
      return Status(Code::kDeadlineExceeded, "no result arrived within " + fixed(seconds, 1) + " s");
    }
    return {};
  }

 private:
  static std::string jsonLine(const v1::ResultInfo& info, std::size_t bytes, double age, bool sharp) {
    JsonObject line;
    line.raw("result", toJson(info)).number("bytes", double(bytes)).number("ageSeconds", age);
    if (sharp) line.flag("sharp", true);
    return line.str();
  }

  /// "gather" of TICK_STAGE_GATHER; a stage that this version does not know is its number.
  static std::string stageText(v1::TickStage stage) {
    constexpr std::string_view kPrefix = "TICK_STAGE_";
    std::string name = v1::TickStage_Name(stage);
    if (name.size() <= kPrefix.size()) return std::to_string(int(stage));
    name.erase(0, kPrefix.size());
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return name;
  }

  std::string stillLine() const {
    const char* next =
        sharpens_ && !lastSharp_ ? "a sharp frame of it is being made" : "nothing is sent until it changes";
    return "the scene stands still at revision " + std::to_string(last_.revision()) + "; " + next;
  }

  std::string summaryLine(double seconds) {
    std::sort(ages_.begin(), ages_.end());
    std::string line = fixed(double(results_) / seconds, 1) + " /s  " + fixed(double(bytes_) / seconds / 1e6, 2) +
                       " MB/s  revision " + std::to_string(last_.revision());
    if (!ages_.empty()) line += "  age " + fixed(ages_[ages_.size() / 2] * 1e3, 1) + " ms ";
    for (const v1::StageTime& stage : last_.stage_times()) {
      line += " " + stageText(stage.stage()) + " " + fixed(stage.seconds() * 1e3, 1);
    }
    return line;
  }

  const bool json_;
  const bool sharpens_;
  const bool terminal_;
  const Clock::time_point began_;
  Clock::time_point lineBegan_ = Clock::now();
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool still_ = false;
  std::vector<double> ages_;
  std::uint64_t bytes_ = 0;
  std::uint64_t results_ = 0;
  v1::ResultInfo last_;
  bool lastSharp_ = false;
  bool ended_ = false;
  Status status_;
};

/// Whether the session is still at the revision that was seen last.
bool standsStill(client::Client& client, const std::string& session, const Report& report) {
  const std::optional<std::uint64_t> seen = report.silentSince();
  if (!seen) return false;
  const Expected<v1::Session> now = client.session(session);
  return now && now->revision() == *seen;
}

/// Runs until the time is over, the stream has ended, or Ctrl-C.
template <typename Watcher>
Status follow(client::Client& client, const WatchOptions& options, Report& report, Watcher& watcher) {
  const Clock::time_point end = options.seconds > 0.0
                                    ? Clock::now() + std::chrono::milliseconds(std::int64_t(options.seconds * 1e3))
                                    : Clock::time_point::max();
  Clock::time_point line = Clock::now() + std::chrono::seconds(1);
  while (Clock::now() < end && !interrupted()) {
    if (report.wait(std::chrono::milliseconds(50))) break;
    if (Clock::now() < line) continue;
    line += std::chrono::seconds(1);
    report.second(standsStill(client, options.id, report));
  }
  watcher.stop();
  return report.finish(watcher.stats());
}

client::WatchHooks hooksFor(Report& report) {
  client::WatchHooks hooks;
  hooks.ended = [&report](const Status& status) { report.end(status); };
  hooks.reopening = [](const Status& status) { warn("the stream broke, reconnecting: " + describe(status)); };
  hooks.notice = [](const v1::Notice& notice) {
    warn("notice " + v1::Notice::Kind_Name(notice.kind()) + ": " + notice.message());
  };
  return hooks;
}

v1::VolumeSubscription volumeWish(const WatchOptions& options) {
  v1::VolumeSubscription wanted;
  wanted.set_session(options.id);
  wanted.set_max_rate(options.rate);
  wanted.set_format(options.format.value_or(v1::VOLUME_FORMAT_HALF_FLOAT));
  wanted.set_tolerance_class(options.tolerance);
  if (!options.region) return wanted;
  const std::vector<double>& box = *options.region;
  v1::Vec3* min = wanted.mutable_region()->mutable_min();
  v1::Vec3* max = wanted.mutable_region()->mutable_max();
  min->set_x(box[0]);
  min->set_y(box[1]);
  min->set_z(box[2]);
  max->set_x(box[3]);
  max->set_y(box[4]);
  max->set_z(box[5]);
  return wanted;
}

Status watch(Context& context, const WatchOptions& options) {
  Expected<client::Client> client = context.connect();
  if (!client) return client.status();
  if (const auto session = client->session(options.id); !session) return session.status();
  Report report(context.json(), options.sharpen);
  if (options.volume) {
    client::VolumeWatcher watcher(
        *client, volumeWish(options), [&](const client::VolumeResult& r) { report.add(r.header.result(), r.bytes); },
        hooksFor(report));
    return follow(*client, options, report, watcher);
  }
  v1::FrameSubscription wanted;
  wanted.set_session(options.id);
  wanted.set_max_rate(options.rate);
  wanted.set_adapt_rate(options.adapt);
  wanted.set_sharpen(options.sharpen);
  wanted.set_camera_name(options.frame.cameraName);
  if (options.frame.hasCamera()) *wanted.mutable_camera()->mutable_camera() = options.frame.camera();
  wanted.set_width(options.frame.pixels().x);
  wanted.set_height(options.frame.pixels().y);
  if (options.frame.exposure) *wanted.mutable_exposure() = *options.frame.exposure;
  wanted.set_samples(options.frame.samples);
  client::FrameWatcher watcher(
      *client, wanted,
      [&](const client::FrameResult& r) { report.add(r.header.result(), r.file.size(), r.header.sharp()); },
      hooksFor(report));
  return follow(*client, options, report, watcher);
}

void addVolumeFlags(CLI::App& command, WatchOptions& options, CLI::Option* volume) {
  addChoice<v1::VolumeFormat>(command, "--format", options.format,
                              {{"half", v1::VOLUME_FORMAT_HALF_FLOAT},
                               {"float", v1::VOLUME_FORMAT_FLOAT},
                               {"compact", v1::VOLUME_FORMAT_COMPACT}},
                              "Format of the volume (default: half); compact needs about a twentieth of the bytes")
      ->needs(volume);
  addParsed<std::vector<double>>(
      command, "--region", options.region, "x0,y0,z0,x1,y1,z1",
      [](const std::string& text) { return parseNumbers(text, {6}); },
      "Watch this box of the world only, metres (default: the whole grid)")
      ->needs(volume);
  command
      .add_option("--tolerance", options.tolerance,
                  "Error class up to which a brick is not sent again, 0 (exact) .. 3 (coarsest)")
      ->needs(volume)
      ->check(CLI::Range(0, 3))
      ->type_name("K")
      ->capture_default_str();
}

}  // namespace

void addWatchCommand(CLI::App& app, Commands& commands) {
  auto given = std::make_shared<WatchOptions>();
  CLI::App& command = commands.add(app, "watch", "Watch a session's results: rate, age, bytes, stage times",
                                   [given](Context& context) { return watch(context, *given); });
  addSession(command, given->id);
  auto* frames = command.add_flag("--frames", given->frames, "Watch frames (the default)");
  auto* volume = command.add_flag("--volume", given->volume, "Watch the volume instead of frames")->excludes(frames);
  addVolumeFlags(command, *given, volume);
  command.add_option("--seconds", given->seconds, "Stop after S seconds (default: run until interrupted)")
      ->type_name("S");
  command.add_option("--rate", given->rate, "Receive at most HZ results per second (default: the server's limit)")
      ->type_name("HZ");
  command
      .add_option("--adapt", given->adapt,
                  "Make frames smaller and coarser while fewer than HZ per second get through (default: never)")
      ->type_name("HZ")
      ->excludes(volume);
  command
      .add_flag("--sharpen", given->sharpen,
                "Once everything rests for a quarter of a second, get one more frame, as frame get makes it")
      ->excludes(volume);
  given->frame.addTo(command);
}

}  // namespace lpv::cli
