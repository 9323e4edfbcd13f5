// lpvd: the only place that knows every layer.

#include <malloc.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <thread>

#include "api/blob_content.h"
#include "api/context.h"
#include "api/store_journal.h"
#include "app/options.h"
#include "app/version.h"
#include "grpc/door.h"
#include "lpv/engine.h"
#include "ops/log.h"
#include "session/access.h"
#include "session/registry.h"
#include "store/sqlite_store.h"

namespace lpv::app {
namespace {

constexpr std::chrono::seconds kShutdownPatience{5};
/// Buffers of at least this many bytes go back to the system when they are freed. Left to itself glibc raises this
/// threshold with the first large one and keeps what the later ones held: 24 MB after a few uploads that broke off.
constexpr int kMappedFrom = 1024 * 1024;

/// Signals are waited for, never handled: blocked here, before any thread starts.
sigset_t blockSignals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file at its limit is an error of that write
  return set;
}

/// Written beside and renamed, so that a reader never sees half a number.
Status writePortFile(const std::string& path, int port) {
  if (path.empty()) return {};
  const std::string partial = path + ".part";
  {
    std::ofstream file(partial);
    file << port << "\n";
    if (!file.flush()) return Status(Code::kUnavailable, "cannot write --port-file " + path, "port-file");
  }
  if (std::rename(partial.c_str(), path.c_str()) == 0) return {};
  return Status(Code::kUnavailable, "cannot write --port-file " + path, "port-file");
}

int fail(const Status& status) {
  std::cerr << "lpvd: " << status.message() << "\n";
  return 1;
}

/// Where sessions are kept.
Expected<std::unique_ptr<store::Store>> openStore(const Options& options, WorkerPool& pool) {
  if (options.stateDir.empty()) return std::unique_ptr<store::Store>(std::make_unique<store::MemoryStore>());
  store::SqliteOptions sqlite;
  sqlite.directory = options.stateDir;
  sqlite.executor = [&pool](std::function<void()> call) { pool.post(std::move(call)); };
  sqlite.onChange = [](const Status& status) {
    if (status.ok()) {
      spdlog::info("the state directory can be written again; nothing was lost");
    } else {
      spdlog::error("{}; edits are refused until then", status.message());
    }
  };
  Expected<std::unique_ptr<store::SqliteStore>> opened = store::SqliteStore::open(std::move(sqlite));
  if (!opened) return opened.status();
  return std::unique_ptr<store::Store>(std::move(*opened));
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

int serve(const Options& options, const sigset_t& signals) {
  // Whoever waits for the file must not find the port of an earlier run.
  if (!options.portFile.empty()) std::remove(options.portFile.c_str());
  Counters counters;
  Timers timers;
  WorkerPool pool(std::max(2U, std::thread::hardware_concurrency()));
  Expected<std::unique_ptr<Engine>> engine = startEngine(options.choice);
  if (!engine) return fail(engine.status());
  Expected<std::unique_ptr<store::Store>> opened = openStore(options, pool);
  if (!opened) return fail(opened.status());
  api::StoreJournal journal(**opened);
  Access access(journal, timers);
  if (const Status status = access.open(); !status.ok()) return fail(status);
  if (const Status status = readAdminToken(options, access); !status.ok()) return fail(status);
  const Workshop workshop{options.limits, engine->get(), &pool, &timers, &counters, api::meshHash, &journal, &access};
  Registry registry(workshop, options.retain);
  if (const Status status = registry.open(); !status.ok()) return fail(status);
  api::Context context{&registry,      &pool,
                       &timers,        &counters,
                       options.limits, (*engine)->device(),
                       kVersion,       std::chrono::system_clock::now(),
                       &access};
  Expected<std::unique_ptr<door::Door>> entrance =
      door::Door::open(context, {options.listen, options.tls, options.reflection || !access.required()});
  if (!entrance) return fail(entrance.status());
  door::Door& door = **entrance;
  if (const Status status = writePortFile(options.portFile, door.port()); !status.ok()) return fail(status);
  if (options.insecure) spdlog::warn("--insecure: anybody who reaches {} can use this server", options.listen);
  spdlog::info("lpvd {} on {} (port {}), {} [{}{}]", kVersion, options.listen, door.port(), context.device.name,
               context.device.platform, context.device.software ? ", software" : "");
  int signal = 0;
  sigwait(&signals, &signal);
  spdlog::info("signal {}: draining", signal);
  door.stopServing();
  registry.drain();
  door.shutdown(kShutdownPatience);
  // Nothing may run that could still reach the registry or the engine when they go.
  timers.stop();
  pool.stop();
  return 0;
}

}  // namespace
}  // namespace lpv::app

int main(int argc, char** argv) {
  using namespace lpv;
  mallopt(M_MMAP_THRESHOLD, app::kMappedFrom);
  const app::Parsed parsed = app::parse(argc, argv);
  if (!parsed.run) return parsed.exitStatus;
  if (const Status status = ops::startLog(parsed.options.logLevel); !status.ok()) {
    std::cerr << "lpvd: " << status.message() << "\n";
    return 2;
  }
  if (parsed.options.listDevices) {
    for (const std::string& line : describeDevices(parsed.options.choice)) std::cout << line << "\n";
    return 0;
  }
  const sigset_t signals = app::blockSignals();
  return app::serve(parsed.options, signals);
}
