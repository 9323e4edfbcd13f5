// stats | health | version

#include "command.h"
#include "output.h"
#include "values.h"

namespace lpv::cli {
namespace {

Status showStats(Context& context) {
  Expected<client::Client> client = context.connect();
  if (!client) return client.status();
  const auto stats = client->stats();
  if (!stats) return stats.status();
  if (context.json()) {
    print(toJson(*stats));
    return {};
  }
  printTable({{"sessions", std::to_string(stats->sessions())},
              {"subscribers", std::to_string(stats->subscribers())},
              {"ticks", std::to_string(stats->ticks())},
              {"results sent", std::to_string(stats->results_sent())},
              {"volumes encoded", std::to_string(stats->volumes_encoded())},
              {"result bytes", std::to_string(stats->result_bytes_sent())},
              {"edits accepted", std::to_string(stats->edits_accepted())},
              {"edits rejected", std::to_string(stats->edits_rejected())},
              {"blobs", std::to_string(stats->blobs())},
              {"blob bytes", std::to_string(stats->blob_bytes())},
              {"resident bytes", std::to_string(stats->resident_bytes())},
              {"worst measured error",
               stats->has_worst_measured_error() ? shortText(stats->worst_measured_error()) : "not yet"},
              {"uptime", std::to_string(stats->uptime().seconds()) + " s"}});
  return {};
}

Status showHealth(Context& context) {
  Expected<client::Client> client = context.connect();
  if (!client) return client.status();
  const auto healthy = client->healthy();
  if (!healthy) return healthy.status();
  const std::string word = *healthy ? "SERVING" : "NOT_SERVING";
  print(context.json() ? JsonObject().text("status", word).str() : word);
  return *healthy ? Status()
                  : Status(Code::kFailedPrecondition, "the server answers but takes no work: it is draining");
}

/// Prints the client's version, and the server's if one answers.
Status showVersion(Context& context) {
  Expected<client::Client> client = context.connect();
  if (!client) return client.status();
  const auto info = client->serverInfo();
  if (context.json()) {
    JsonObject json;
    json.text("client", client::version());
    if (info) json.raw("server", toJson(*info));
    print(json.str());
    return {};
  }
  print(std::string("lpvctl ") + client::version());
  if (info)
    print("lpvd " + info->version() + " on " + info->device().name() +
          (info->device().software() ? " (software)" : ""));
  return {};
}

}  // namespace

void addServerCommands(CLI::App& app, Commands& commands) {
  commands.add(app, "stats", "Print counters of the server", showStats);
  commands.add(app, "health", "Print whether the server serves; exit code 0 if it does", showHealth);
  commands.add(app, "version", "Print the versions of lpvctl and, if it answers, of the server", showVersion);
}

}  // namespace lpv::cli
