// lpvctl: the command line of lpv.v1.

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>

#include "command.h"
#include "interrupt.h"
#include "progress.h"

namespace lpv::cli {
namespace {

void addGlobals(CLI::App& app, Globals& globals) {
  globals.server = "localhost:50051";
  app.add_option("--server", globals.server, "Server to talk to")->envname("LPV_SERVER")->type_name("HOST:PORT");
  app.add_flag("--json", globals.json, "Results as JSON: one object, or one per line for list and watch");
  app.add_option("--token-file", globals.tokenFile, "File with the access token (else LPV_TOKEN)")->type_name("FILE");
  app.add_option("--ca", globals.ca, "TLS: certificates that vouch for the server, PEM")->type_name("FILE");
  app.add_option("--cert", globals.cert, "TLS: this client's certificate, PEM")->type_name("FILE");
  app.add_option("--key", globals.key, "TLS: its private key, PEM")->type_name("FILE");
  app.add_option("--timeout", globals.timeoutSeconds, "Longest wait for one answer")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.001, 86400.0));
}

void addCommands(CLI::App& app, Commands& commands) {
  addSessionCommands(app, commands);
  addSceneCommands(app, commands);
  addLightCommands(app, commands);
  addSurfaceCommands(app, commands);
  addHistoryCommands(app, commands);
  addPickCommand(app, commands);
  addVolumeCommands(app, commands);
  addProbeCommand(app, commands);
  addFrameCommands(app, commands);
  addWatchCommand(app, commands);
  addRenderCommand(app, commands);
  addServerCommands(app, commands);
}

int usage(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return app.exit(error);  // --help
  std::string line = error.what();
  line = line.substr(0, line.find('\n'));
  std::cerr << "lpvctl: " << line << " (lpvctl --help says what there is)\n";
  return int(Exit::kUsage);
}

int run(const Globals& globals, const Action& action) {
  Context context(globals);
  Status status;
  try {
    status = action(context);
  } catch (const std::bad_alloc&) {
    status = Status(Code::kResourceExhausted, "this machine has not enough memory for that");
  }
  if (status.ok()) return int(Exit::kOk);
  if (interrupted()) status = Status(Code::kCancelled, "interrupted");
  std::cerr << "lpvctl: " << describe(status) << "\n";
  return int(exitFor(status));
}

}  // namespace
}  // namespace lpv::cli

int main(int argc, char** argv) {
  setenv("GRPC_VERBOSITY", "NONE", 0);  // stderr is for one line of ours
  lpv::cli::watchInterrupts();
  CLI::App app("Lights a scene over the network: sessions, scenes, lights, pictures. Talks to lpvd.", "lpvctl");
  app.require_subcommand(1);
  app.fallthrough();
  lpv::cli::Globals globals;
  lpv::cli::Commands commands;
  lpv::cli::addGlobals(app, globals);
  lpv::cli::addCommands(app, commands);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return lpv::cli::usage(app, error);
  }
  return lpv::cli::run(globals, commands.chosen());
}
