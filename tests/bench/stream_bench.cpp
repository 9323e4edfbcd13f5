// What streams of volumes give over a line with a delay, to a slow reader, and to many. A procedural room whose light
// moves 30 times a second, an lpvd of its own. Numbers, not verdicts: nothing fails for being slow.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bench/load_session.h"
#include "bench/rows.h"
#include "bench/service_load.h"
#include "lpv/client.h"
#include "lpv/watch.h"
#include "rpc/support/server_process.h"
#include "rpc/support/tcp_proxy.h"

namespace lpv::bench {
namespace {

using Steady = std::chrono::steady_clock;

constexpr int kWarmUp = 10;  // results that are not counted
constexpr double kEditsPerSecond = 30.0;
constexpr std::chrono::milliseconds kSlowReader{500};
constexpr std::chrono::seconds kSettling{3};

struct Options {
  int results = 60;
  int delay = 100;
  int grid = 16;
  std::vector<int> readers = {1, 10, 50};
  bool readersOnly = false;
  int stillSeconds = 0;
  std::string rowsFile;
};

/// A result as its reader got it.
struct Seen {
  Steady::time_point when;
  double age = 0.0;  ///< seconds since the tick was complete; server and reader share a clock
};

client::Client clientOf(const std::string& address) {
  client::ConnectOptions options;
  options.address = address;
  return *client::Client::connect(options);
}

/// Moves the light until destroyed.
class Mover {
 public:
  explicit Mover(LoadSession& session) : session_(session), thread_([this] { run(); }) {}
  ~Mover() {
    stopping_ = true;
    thread_.join();
  }
  Mover(const Mover&) = delete;
  Mover& operator=(const Mover&) = delete;

 private:
  void run() {
    const auto start = Steady::now();
    for (int i = 1; !stopping_; ++i) {
      (void)session_.client().applyEdit(session_.id(), session_.step(i)).ok();
      std::this_thread::sleep_until(start + i * std::chrono::duration<double>(1.0 / kEditsPerSecond));
    }
  }
  LoadSession& session_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

/// Watches volumes; takes `busy` for each.
class Watching {
 public:
  Watching(const std::string& address, const std::string& session, bool twoCredits, std::chrono::milliseconds busy)
      : client_(clientOf(address)), busy_(busy) {
    v1::VolumeSubscription subscription;
    subscription.set_session("sessions/" + session);
    subscription.set_format(v1::VOLUME_FORMAT_COMPACT);
    subscription.set_credits(twoCredits ? 2 : 1);
    watcher_ = std::make_unique<client::VolumeWatcher>(
        client_, subscription, [this](const client::VolumeResult& result) { take(result.header.result()); });
  }

  /// Waits for `count` results after the warm-up and returns them.
  std::vector<Seen> collect(int count) {
    std::unique_lock lock(mutex_);
    const std::size_t wanted = std::size_t(kWarmUp + count);
    more_.wait(lock, [&] { return seen_.size() >= wanted; });
    return {seen_.begin() + kWarmUp, seen_.begin() + std::ptrdiff_t(wanted)};
  }
  std::size_t count() const {
    const std::lock_guard lock(mutex_);
    return seen_.size();
  }

 private:
  void take(const v1::ResultInfo& info) {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const std::int64_t nowNs = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
    {
      const std::lock_guard lock(mutex_);
      seen_.push_back({Steady::now(), double(nowNs - info.server_time_ns()) * 1e-9});
    }
    more_.notify_all();
    std::this_thread::sleep_for(busy_);
  }

  client::Client client_;
  std::chrono::milliseconds busy_;
  mutable std::mutex mutex_;
  std::condition_variable more_;
  std::vector<Seen> seen_;
  std::unique_ptr<client::VolumeWatcher> watcher_;  ///< last: its thread uses all of the above
};

double perSecond(const std::vector<Seen>& seen) {
  return double(seen.size() - 1) / std::chrono::duration<double>(seen.back().when - seen.front().when).count();
}

Row rowOf(const Options& options, const std::string& reader, const std::vector<Seen>& seen) {
  std::vector<double> ages;
  for (const Seen& each : seen) ages.push_back(each.age * 1e3);
  return {reader,
          "streams",
          {{"grid", double(options.grid)}},
          {{"results_per_s", perSecond(seen)},
           {"age_p50_ms", medianOf(ages)},
           {"age_max_ms", *std::max_element(ages.begin(), ages.end())}}};
}

/// Processor time of a process so far, seconds; see proc(5).
double processorSeconds(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string word;
  double ticks = 0.0;
  for (int field = 1; field <= 15 && file >> word; ++field) {
    if (field >= 14) ticks += std::stod(word);
  }
  return ticks / double(sysconf(_SC_CLK_TCK));
}

void delayed(const Options& options, rpc::ServerProcess& server, LoadSession& session, Rows* rows) {
  rpc::TcpProxy proxy(server.port());
  proxy.setDelay(std::chrono::milliseconds(options.delay / 2));
  for (const bool two : {false, true}) {
    Watching watching(proxy.address(), session.id(), two, std::chrono::milliseconds(0));
    const std::string line = std::to_string(options.delay) + " ms of round trip, ";
    rows->add(rowOf(options, line + (two ? "two credits" : "one credit"), watching.collect(options.results)));
  }
}

/// What a session costs in which nothing happens, with two subscribers.
void still(const Options& options, rpc::ServerProcess& server, LoadSession& session, Rows* rows) {
  const Watching one(server.address(), session.id(), false, std::chrono::milliseconds(0));
  const Watching other(server.address(), session.id(), true, std::chrono::milliseconds(0));
  std::this_thread::sleep_for(kSettling);
  const double before = processorSeconds(server.process().pid());
  std::this_thread::sleep_for(std::chrono::seconds(options.stillSeconds));
  const double spent = processorSeconds(server.process().pid()) - before;
  rows->add({"nobody edits, two subscribers",
             "static session",
             {{"grid", double(options.grid)}, {"seconds", double(options.stillSeconds)}},
             {{"share_of_a_core", spent / options.stillSeconds}}});
}

void slow(const Options& options, rpc::ServerProcess& server, LoadSession& session, Rows* rows) {
  Watching watching(server.address(), session.id(), false, kSlowReader);
  const std::string reader = "a reader busy for " + std::to_string(kSlowReader.count()) + " ms with each";
  rows->add(rowOf(options, reader, watching.collect(std::max(4, options.results / 6))));
}

void many(const Options& options, rpc::ServerProcess& server, LoadSession& session, Rows* rows) {
  for (const int readers : options.readers) {
    std::vector<std::unique_ptr<Watching>> watching;
    for (int i = 0; i < readers; ++i) {
      watching.push_back(
          std::make_unique<Watching>(server.address(), session.id(), false, std::chrono::milliseconds(0)));
    }
    (void)watching.front()->collect(1);
    const auto before = session.client().stats();
    const double cpuBefore = processorSeconds(server.process().pid());
    (void)watching.front()->collect(1 + options.results);
    const double cpu = processorSeconds(server.process().pid()) - cpuBefore;
    const auto after = session.client().stats();
    if (!before || !after) return;
    const double ticks = double(after->ticks() - before->ticks());
    const double results = double(after->results_sent() - before->results_sent());
    const double encoded = double(after->volumes_encoded() - before->volumes_encoded());
    rows->add({"room with a moving light",
               "readers",
               {{"grid", double(options.grid)}, {"readers", double(readers)}},
               {{"results_a_tick", results / ticks},
                {"encodings_a_tick", encoded / ticks},
                {"processor_ms", cpu / ticks * 1e3}}});
  }
}

int measure(const Options& options) {
  rpc::ServerProcess server;
  Load load;
  load.grid = options.grid;
  LoadSession session(load, clientOf(server.address()), server.address());
  if (const Status status = session.prepare(); !status.ok()) {
    std::cerr << "stream_bench: " << status.message() << "\n";
    return 1;
  }
  const auto info = session.client().serverInfo();
  Rows rows(options.rowsFile, info ? info->device().name() : "");
  if (options.stillSeconds > 0) still(options, server, session, &rows);
  const Mover mover(session);
  if (!options.readersOnly) {
    delayed(options, server, session, &rows);
    slow(options, server, session, &rows);
  }
  many(options, server, session, &rows);
  return 0;
}

}  // namespace
}  // namespace lpv::bench

int main(int argc, char** argv) {
  lpv::bench::Options options;
  CLI::App app("Measures streams of volumes: over a delayed line, to a slow reader, to many readers");
  app.add_option("--results", options.results, "results that are counted for each line")
      ->check(CLI::Range(10, 100000))
      ->capture_default_str();
  app.add_option("--delay", options.delay, "round trip that a proxy adds, ms")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  app.add_option("--grid", options.grid, "cells along the longest edge")
      ->check(CLI::Range(1, 128))
      ->capture_default_str();
  app.add_option("--readers", options.readers, "of one volume, at a time")->delimiter(',')->capture_default_str();
  app.add_flag("--readers-only", options.readersOnly, "neither the delayed line nor the slow reader");
  app.add_option("--still", options.stillSeconds, "seconds in which nobody edits, before all else")
      ->check(CLI::Range(0, 3600))
      ->capture_default_str();
  app.add_option("--rows", options.rowsFile, lpv::bench::kRowsHelp);
  CLI11_PARSE(app, argc, argv);
  return lpv::bench::measure(options);
}
