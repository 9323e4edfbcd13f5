// lpvd: the only place that knows every layer.

#include <malloc.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <thread>

#include "api/call/address_limit.h"
#include "api/call/context.h"
#include "app/options.h"
#include "app/signals.h"
#include "app/version.h"
#include "convert/blob_content.h"
#include "engine/device_choice.h"
#include "engine/engine.h"
#include "gpu/device.h"
#include "grpc/door.h"
#include "ops/audit.h"
#include "ops/endpoint.h"
#include "ops/health.h"
#include "ops/log.h"
#include "ops/log_scope.h"
#include "ops/metrics.h"
#include "persistence/persistent_journal.h"
#include "session/access.h"
#include "session/memory_journal.h"
#include "session/registry.h"
#include "store/sqlite/sqlite_backend.h"
#include "tls/follower.h"
#include "web/door.h"

namespace lpv::app {
namespace {

constexpr std::chrono::seconds kShutdownPatience{5};
/// Of the thread that encodes large pictures, so that calls beside it are answered as if it were not there.
constexpr int kBackgroundNice = 10;
/// Buffers of at least this many bytes go back to the system when they are freed. Left to itself glibc raises this
/// threshold with the first large one and keeps what the later ones held: 24 MB after a few uploads that broke off, as
/// with 16 MB here, where they stayed at the ends of several threads' heaps.
constexpr int kMappedFrom = 4 * 1024 * 1024;
/// As much is kept at the end of each heap. Unless it is set with the threshold above, glibc gives back all but 128 kB,
/// so that the pages of every larger buffer are made anew: a tree over 33,000 triangles took five times as long.
constexpr int kKeptAtEnd = 16 * 1024 * 1024;
/// Smaller ones that were freed glibc keeps: 500 MB after headers that did not end. Where they are as many as this,
/// they are given back every so often.
constexpr std::size_t kTrimFrom = 16 * 1024 * 1024;
constexpr std::chrono::seconds kTrimEvery{5};

/// Written beside and renamed, so that a reader never sees half a number.
Status writePortFile(const char* flag, const std::string& path, int port) {
  if (path.empty()) return {};
  const std::string partial = path + ".part";
  {
    std::ofstream file(partial);
    file << port << "\n";
    if (!file.flush()) return Status(Code::kUnavailable, std::string("cannot write ") + flag + " " + path);
  }
  if (std::rename(partial.c_str(), path.c_str()) == 0) return {};
  return Status(Code::kUnavailable, std::string("cannot write ") + flag + " " + path);
}

int fail(const Status& status) {
  std::cerr << "lpvd: " << status.message() << "\n";
  return 1;
}

/// Where sessions are kept, with the queue before it; null without --state-dir.
Expected<std::unique_ptr<store::CommitQueue>> openStore(const Options& options, WorkerPool& pool, Counters& counters) {
  if (options.stateDir.empty()) return std::unique_ptr<store::CommitQueue>();
  store::SqliteOptions sqlite;
  sqlite.directory = options.stateDir;
  Expected<std::unique_ptr<store::SqliteBackend>> tables = store::SqliteBackend::open(std::move(sqlite));
  if (!tables) return tables.status();
  store::CommitQueueOptions queue;
  queue.executor = [&pool](std::function<void()> call) { pool.post(std::move(call)); };
  queue.onCommit = [&counters](std::chrono::duration<double> took, bool committed) {
    counters.storeCommitSeconds.observe(took.count());
    if (!committed) ++counters.storeFailures;
  };
  queue.onChange = [](const Status& status) {
    if (status.ok()) {
      spdlog::info("the state directory can be written again; nothing was lost");
    } else {
      spdlog::error("{}; edits are refused until then", status.message());
    }
  };
  return std::make_unique<store::CommitQueue>(std::move(*tables), std::move(queue));
}

/// The journal in `queue`; one that keeps nothing where there is none.
std::unique_ptr<Journal> makeJournal(store::CommitQueue* queue) {
  if (!queue) return std::make_unique<MemoryJournal>();
  return std::make_unique<api::PersistentJournal>(*queue);
}

/// Makes the first line of --admin-token-file the admin's token.
Status readAdminToken(const Options& options, Access& access) {
  if (options.adminTokenFile.empty()) return {};
  std::ifstream file(options.adminTokenFile);
  std::string token;
  std::getline(file, token);
  if (!file && token.empty()) {
    return invalid("admin-token-file", "cannot read --admin-token-file " + options.adminTokenFile + ", or it is empty");
  }
  while (!token.empty() && std::isspace(static_cast<unsigned char>(token.back())) != 0) token.pop_back();
  return access.require(token);
}

/// What happened to a session that nobody asked for.
void report(SessionEvent incident, const std::string& session, const std::string& why) {
  const ops::LogScope scope({.session = session, .trace = {}, .peer = {}});
  switch (incident) {
    case SessionEvent::kExpired:
      return ops::audit("expire", {{"why", "ttl"}});
    case SessionEvent::kRetentionEnded:
      return ops::audit("expire", {{"why", "retain"}});
    case SessionEvent::kEvicted:
      return spdlog::info("idle: evicted; on disk only");
    case SessionEvent::kTickFailed:
      return spdlog::error("a tick failed: {}", why);
    case SessionEvent::kDamaged:
      return spdlog::error("this session is damaged and cannot be brought back: {}", why);
  }
}

/// The endpoint of --ops-listen; null where it is not wanted.
Expected<std::unique_ptr<ops::Endpoint>> openOps(const Options& options, const ops::Health& health) {
  if (options.opsListen.empty()) return std::unique_ptr<ops::Endpoint>();
  Expected<std::unique_ptr<ops::Endpoint>> endpoint = ops::Endpoint::open(options.opsAt, health);
  if (!endpoint) return endpoint;
  if (Status s = writePortFile("--ops-port-file", options.opsPortFile, (*endpoint)->port()); !s.ok()) return s;
  spdlog::info("/live, /ready and /metrics on {} (port {})", options.opsListen, (*endpoint)->port());
  if (!isLoopback(options.opsAt.host))
    spdlog::warn("--ops-listen {}: whoever reaches it reads health and metrics, without a token", options.opsListen);
  return endpoint;
}

/// What calls can reach.
api::Context callContext(Registry& registry, const SessionServices& services, WorkerPool* background) {
  return {.registry = &registry,
          .pool = services.pool,
          .timers = services.timers,
          .counters = services.counters,
          .limits = services.limits,
          .device = services.engine->device(),
          .version = kVersion,
          .started = std::chrono::system_clock::now(),
          .access = services.access,
          .answers = services.answers,
          .background = background};
}

void publish(ops::Endpoint& endpoint, const api::Context& context, const SessionServices& services,
             const store::CommitQueue* queue) {
  ops::MetricSources sources;
  sources.counters = context.counters;
  sources.answers = context.answers.get();
  sources.damaged = services.damaged.get();
  sources.registry = context.registry;
  sources.journal = services.journal;
  sources.storeQueue = [queue] { return queue ? queue->queued() : 0; };
  sources.engine = services.engine;
  sources.device = context.device;
  sources.version = context.version;
  sources.started = context.started;
  endpoint.publish([sources] { return ops::renderMetrics(sources); });
}

/// What is done about TLS files that changed and cannot be used, or can be again.
tls::OnTrouble tlsTrouble(Counters& counters, ops::Health& health) {
  return [&counters, &health](const Status& status) {
    health.setWarning(status.message());
    if (status.ok()) return spdlog::info("the TLS files are good again, and in use");
    ++counters.certificateFailures;
    spdlog::error("{}; the last good certificate stays in use", status.message());
  };
}

/// PROTOCOL.md's order as far as a server without peers goes. It says that it does not serve when everything accepted
/// is kept, and before the first stream has its notice: who has that, and asks, must not be sent here again.
void drain(Registry& registry, grpc_door::Door& door, web_door::Door* web, ops::Health& health) {
  if (const Status kept = registry.quiesce(); !kept.ok()) spdlog::error("while draining: {}", kept.message());
  health.stopServing();
  door.stopServing();
  registry.drain();
  std::thread browsers([web] {
    if (web != nullptr) web->shutdown(kShutdownPatience);
  });
  door.shutdown(kShutdownPatience);
  browsers.join();
}

/// The certificates of both doors; null for plain text.
Expected<std::unique_ptr<tls::Follower>> followTls(const Options& options, Counters& counters, ops::Health& health) {
  if (!options.tls.given()) return std::unique_ptr<tls::Follower>();
  return tls::Follower::follow(options.tls, tlsTrouble(counters, health));
}

/// The door of --web; null where it is not wanted.
Expected<std::unique_ptr<web_door::Door>> openWeb(const Options& options, const api::Context& context,
                                                  tls::Follower* certificates) {
  if (options.web.empty()) return std::unique_ptr<web_door::Door>();
  Expected<web_door::Origins> origins = web_door::Origins::read(options.webOrigins);
  if (!origins) return origins.status();
  Expected<web_door::Files> files =
      options.webFiles.empty() ? web_door::Files::embedded() : web_door::Files::of(options.webFiles);
  if (!files) return files.status();
  const bool page = files->hasPage();
  auto door = web_door::Door::open(context, {.address = options.web,
                                             .origins = std::move(*origins),
                                             .files = std::move(*files),
                                             .certificates = certificates});
  if (!door) return door;
  const int port = (*door)->port();
  if (Status s = writePortFile("--web-port-file", options.webPortFile, port); !s.ok()) return s;
  const char* scheme = certificates == nullptr ? "http" : "https";
  spdlog::info("browsers: {}://{}/", scheme, HostPort{options.webAt.host, port}.text());
  if (!page)
    spdlog::warn("--web: this lpvd was built without its page (npm was missing); programs can call, browsers see why");
  return door;
}

/// What SIGHUP makes anew, each by itself: what cannot be read stays as it was.
class Reloader {
 public:
  Reloader(int argc, char** argv, Options& options, Access& access, Registry& registry)
      : argc_(argc), argv_(argv), options_(options), access_(access), registry_(registry) {}

  void run() {
    token();
    limits();
  }

 private:
  void token() {
    const Status read = readAdminToken(options_, access_);
    if (!read.ok()) return spdlog::error("SIGHUP: {}; what was read before is kept", read.message());
    spdlog::info("SIGHUP: --admin-token-file {}", options_.adminTokenFile.empty() ? "is not given" : "was read again");
  }

  void limits() {
    const Expected<Reload> read = reload(argc_, argv_, options_);
    if (!read) return spdlog::error("SIGHUP: {}; the limits stay as they were", read.status().message());
    registry_.setLimits(read->limits);
    for (const std::string& change : read->applied) spdlog::info("SIGHUP: {}", change);
    for (const std::string& flag : read->kept)
      spdlog::warn("SIGHUP: {} has changed, which takes effect at the next start", flag);
  }

  int argc_;
  char** argv_;
  Options& options_;
  Access& access_;
  Registry& registry_;
};

/// Whoever waits for the files must not find the ports of an earlier run.
void removePortFiles(const Options& options) {
  for (const std::string& file : {options.portFile, options.opsPortFile, options.webPortFile}) {
    if (!file.empty()) std::remove(file.c_str());
  }
}

void announce(const Options& options, const Access& access, int port, const DeviceInfo& device) {
  if (options.insecure && !access.required()) {
    spdlog::warn("--insecure: anybody who reaches {} can use this server", options.listen);
  } else if (options.insecure && !options.tls.given()) {
    spdlog::warn("--insecure: access tokens come to {} in plain text", options.listen);
  }
  spdlog::info("lpvd {} on {} (port {}), {} [{}{}]", kVersion, options.listen, port, device.name, device.platform,
               device.software ? ", software" : "");
}

void trimMemory(Timers& timers, WorkerPool& background) {
  timers.at(Clock::now() + kTrimEvery, [&timers, &background] {
    background.post([] {
      if (mallinfo2().fordblks >= kTrimFrom) malloc_trim(0);
    });
    trimMemory(timers, background);
  });
}

int serve(int argc, char** argv, Options options, Signals& signals) {
  removePortFiles(options);
  Counters counters;
  ops::Health health(counters);
  Expected<std::unique_ptr<ops::Endpoint>> early = openOps(options, health);
  if (!early) return fail(early.status());
  Timers timers;
  WorkerPool pool(std::max(2U, std::thread::hardware_concurrency()));
  WorkerPool background(1, kBackgroundNice);
  Expected<std::unique_ptr<Engine>> engine = startEngine(options.choice);
  if (!engine) return fail(engine.status());
  Expected<std::unique_ptr<store::CommitQueue>> queue = openStore(options, pool, counters);
  if (!queue) return fail(queue.status());
  const std::unique_ptr<Journal> journal = makeJournal(queue->get());
  Access access(*journal, timers);
  if (const Status status = access.open(); !status.ok()) return fail(status);
  if (const Status status = readAdminToken(options, access); !status.ok()) return fail(status);
  const SessionServices services{.limits = options.limits,
                                 .engine = engine->get(),
                                 .pool = &pool,
                                 .timers = &timers,
                                 .counters = &counters,
                                 .hasher = api::meshHash,
                                 .journal = journal.get(),
                                 .access = &access,
                                 .onEvent = report};
  Registry registry(services, options.retain);
  if (const Status status = registry.open(); !status.ok()) return fail(status);
  api::Context context = callContext(registry, services, &background);
  context.addresses = std::make_shared<api::AddressLimit>(options.trustedProxies);
  const Expected<std::unique_ptr<tls::Follower>> certificates = followTls(options, counters, health);
  if (!certificates) return fail(certificates.status());
  Expected<std::unique_ptr<grpc_door::Door>> entrance =
      grpc_door::Door::open(context, {.address = options.listen,
                                      .certificates = certificates->get(),
                                      .reflection = options.reflection || !access.required()});
  if (!entrance) return fail(entrance.status());
  grpc_door::Door& door = **entrance;
  const Expected<std::unique_ptr<web_door::Door>> web = openWeb(options, context, certificates->get());
  if (!web) return fail(web.status());
  health.serve(*journal, *services.damaged);
  const std::unique_ptr<ops::Endpoint> endpoint = std::move(*early);  // destroyed before the objects that it reads
  if (endpoint) publish(*endpoint, context, services, queue->get());
  announce(options, access, door.port(), context.device);
  if (const Status status = writePortFile("--port-file", options.portFile, door.port()); !status.ok())
    return fail(status);
  checkKeptSessions(services, background, [damaged = services.damaged](std::size_t checked) {
    if (checked > 0) spdlog::info("state directory: {} sessions read, {} are damaged", checked, damaged->count());
  });
  trimMemory(timers, background);
  Reloader reloader(argc, argv, options, access, registry);
  const int signal = signals.waitForEnd([&] { reloader.run(); });
  spdlog::info("signal {}: draining", signal);
  drain(registry, door, web->get(), health);
  // Nothing may run that could still reach the registry or the engine when they go.
  timers.stop();
  background.stop();
  pool.stop();
  return 0;
}

}  // namespace
}  // namespace lpv::app

int main(int argc, char** argv) {
  using namespace lpv;
  gpu::askForSoftwareWorkers();
  mallopt(M_MMAP_THRESHOLD, app::kMappedFrom);
  mallopt(M_TRIM_THRESHOLD, app::kKeptAtEnd);
  const app::Parsed parsed = app::parse(argc, argv);
  if (!parsed.run) return parsed.exitStatus;
  if (const Status status = ops::startLog(parsed.options.logLevel, parsed.options.logFormat); !status.ok()) {
    std::cerr << "lpvd: " << status.message() << "\n";
    return 2;
  }
  if (!parsed.options.ignoredVariables.empty())
    spdlog::warn("variables that set no option of lpvd are ignored: {}", parsed.options.ignoredVariables);
  if (parsed.options.listDevices) {
    for (const std::string& line : describeDevices(parsed.options.choice)) std::cout << line << "\n";
    return 0;
  }
  app::Signals signals;
  return app::serve(argc, argv, parsed.options, signals);
}
