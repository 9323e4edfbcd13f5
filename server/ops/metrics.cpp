#include "ops/metrics.h"

#include <prometheus/metric_family.h>
#include <prometheus/text_serializer.h>

#include <limits>
#include <sstream>
#include <utility>
#include <vector>

#include "ops/process.h"

namespace lpv::ops {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;
using Labels = std::vector<ClientMetric::Label>;

/// Collects metric families in the order in which they are written.
class Scrape {
 public:
  /// Begins a family; later values are added to it.
  void family(MetricType type, const char* name, const char* help) {
    MetricFamily& begun = families_.emplace_back();
    begun.name = name;
    begun.help = help;
    begun.type = type;
  }
  void add(double value, Labels labels = {}) {
    ClientMetric& metric = families_.back().metric.emplace_back();
    metric.label = std::move(labels);
    metric.gauge.value = value;
    metric.counter.value = value;
  }
  void add(const DurationHistogram& durations, Labels labels = {}) {
    ClientMetric& metric = families_.back().metric.emplace_back();
    metric.label = std::move(labels);
    std::int64_t below = 0;
    for (std::size_t i = 0; i < DurationHistogram::kBuckets; ++i) {
      below += durations.count(i);
      const bool last = i == DurationHistogram::kBounds.size();
      const double bound = last ? std::numeric_limits<double>::infinity() : DurationHistogram::kBounds[i];
      metric.histogram.bucket.push_back({std::uint64_t(below), bound});
    }
    metric.histogram.sample_count = std::uint64_t(below);
    metric.histogram.sample_sum = durations.sum();
  }

  void gauge(const char* name, const char* help, double value) {
    family(MetricType::Gauge, name, help);
    add(value);
  }
  void counter(const char* name, const char* help, double value) {
    family(MetricType::Counter, name, help);
    add(value);
  }
  void histogram(const char* name, const char* help, const DurationHistogram& durations) {
    family(MetricType::Histogram, name, help);
    add(durations);
  }
  /// One series per reason from the first scrape on, so that an alert sees the first refusal.
  void reasons(const char* name, const char* help, const ReasonCounter& counter) {
    family(MetricType::Counter, name, help);
    for (std::size_t i = 1; i < kReasons.size(); ++i) add(double(counter.count(i)), {{"reason", kReasons[i]}});
  }

  std::string text() const {
    std::ostringstream out;
    prometheus::TextSerializer().Serialize(out, families_);
    return out.str();
  }

 private:
  std::vector<MetricFamily> families_;
};

void addServer(const MetricSources& s, Scrape& out) {
  out.family(MetricType::Gauge, "lpv_build_info", "Always 1; the version is its label.");
  out.add(1.0, {{"version", s.version}});
  out.family(MetricType::Gauge, "lpv_device_info", "Always 1; the device that lights is in its labels.");
  out.add(1.0, {{"name", s.device.name},
                {"vendor", s.device.vendor},
                {"version", s.device.version},
                {"platform", s.device.platform},
                {"software", s.device.software ? "true" : "false"}});
}

void addSessions(const MetricSources& s, Scrape& out) {
  const SessionTotals totals = s.registry->totals();
  out.gauge("lpv_sessions", "Sessions in memory.", double(totals.sessions));
  out.gauge("lpv_sessions_kept", "Sessions in the state directory, in memory or not.", double(s.registry->keptCount()));
  out.gauge("lpv_clients", "Joined clients of the sessions in memory.", double(totals.clients));
  out.gauge("lpv_subscribers", "Open result streams.", double(totals.subscribers));
  out.gauge("lpv_blob_bytes", "Uploaded meshes and textures of the sessions in memory, bytes.",
            double(totals.blobBytes));
  out.family(MetricType::Gauge, "lpv_measured_error_worst",
             "Largest measured error among sessions, relative; absent where none was measured.");
  if (totals.worstMeasuredError) out.add(*totals.worstMeasuredError);
}

void addTicks(const Counters& c, const Engine& engine, Scrape& out) {
  out.histogram("lpv_tick_seconds", "From asking for a tick to having it, other sessions' turns included.",
                c.tickSeconds);
  out.family(MetricType::Histogram, "lpv_stage_seconds", "A stage of a tick, without other sessions' turns.");
  for (std::size_t i = 0; i < kStages; ++i) out.add(c.stageSeconds[i], {{"stage", nameOf(Stage(i))}});
  out.reasons("lpv_tick_failures_total", "Ticks that failed.", c.tickWatch.failures());
  out.counter("lpv_context_losses_total", "Times the graphics context was found lost.", double(engine.contextLosses()));
}

void addResults(const MetricSources& s, Scrape& out) {
  const Counters& c = *s.counters;
  out.family(MetricType::Counter, "lpv_results_total", "Results encoded for readers.");
  for (std::size_t i = 0; i < kSentNames.size(); ++i)
    out.add(double(c.sent[i].results), {{"kind", kSentNames[i].kind}, {"format", kSentNames[i].format}});
  out.family(MetricType::Counter, "lpv_result_bytes_total", "Payload bytes of results for readers.");
  for (std::size_t i = 0; i < kSentNames.size(); ++i)
    out.add(double(c.sent[i].bytes), {{"kind", kSentNames[i].kind}, {"format", kSentNames[i].format}});
  out.counter("lpv_results_coalesced_total",
              "Results that a subscriber was not sent because a later one replaces them.", double(c.resultsCoalesced));
  out.counter("lpv_volumes_encoded_total", "Volumes encoded, once for all who need the same.",
              double(c.volumesEncoded));
  out.gauge("lpv_answer_bytes", "Bytes that answers in progress hold.", double(s.answers->held()));
  out.gauge("lpv_answer_bytes_peak", "The most bytes that answers in progress have held since the start.",
            double(s.answers->peak()));
  out.histogram("lpv_acknowledge_lag_seconds", "From giving a subscriber a result to its acknowledgement.",
                c.acknowledgeLag);
}

void addCalls(const Counters& c, Scrape& out) {
  out.counter("lpv_edits_accepted_total", "Edits that were applied.", double(c.editsAccepted));
  out.reasons("lpv_edits_rejected_total", "Edits that changed nothing, by the limit that was met or the code.",
              c.editsRejected);
  out.counter("lpv_address_bans_total", "Times that an address lost its connections for flooding with calls.",
              double(c.addressBans));
  out.gauge("lpv_web_sockets", "Open sockets of browsers.", double(c.webSockets));
  out.family(MetricType::Counter, "lpv_web_refused_total", "Requests and sockets of browsers that were refused.");
  for (std::size_t i = 0; i < kWebRefusals.size(); ++i) out.add(double(c.webRefused[i]), {{"why", kWebRefusals[i]}});
  out.reasons("lpv_calls_refused_total", "Calls that ended with an error before anything was answered.",
              c.callsRefused);
}

void addStore(const MetricSources& s, Scrape& out) {
  out.gauge("lpv_store_writable", "1 while changes can be kept, else 0: edits are refused.",
            s.journal->available().ok() ? 1.0 : 0.0);
  out.gauge("lpv_store_queued_changes", "Changes that wait for the disk.", double(s.storeQueue()));
  out.histogram("lpv_store_commit_seconds", "A transaction of the state directory, fsync included.",
                s.counters->storeCommitSeconds);
  out.counter("lpv_store_failures_total", "Transactions that could not be committed; they are tried again.",
              double(s.counters->storeFailures));
  out.gauge("lpv_sessions_damaged", "Sessions in the state directory that cannot be brought back.",
            double(s.damaged->count()));
  out.counter("lpv_certificate_failures_total",
              "Times that changed TLS files could not be used; the last good ones stay in use.",
              double(s.counters->certificateFailures));
}

void addProcess(const MetricSources& s, Scrape& out) {
  const ProcessUse use = processUse();
  out.counter("process_cpu_seconds_total", "CPU time of all threads, user and system.", use.cpuSeconds);
  out.gauge("process_resident_memory_bytes", "Resident memory.", double(use.residentBytes));
  out.gauge("process_open_fds", "Open files and sockets.", double(use.openFiles));
  out.gauge("process_start_time_seconds", "When the server started, seconds since 1970.",
            std::chrono::duration<double>(s.started.time_since_epoch()).count());
}

}  // namespace

std::string renderMetrics(const MetricSources& sources) {
  Scrape out;
  addServer(sources, out);
  addSessions(sources, out);
  addTicks(*sources.counters, *sources.engine, out);
  addResults(sources, out);
  addCalls(*sources.counters, out);
  addStore(sources, out);
  addProcess(sources, out);
  return out.text();
}

}  // namespace lpv::ops
