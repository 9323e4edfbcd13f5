// lpvctl: the command line of lpv.v1.

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>

#include "command.h"
#include "interrupt.h"
#include "output.h"
#include "progress.h"

namespace lpv::cli {
namespace {

void addGlobals(CLI::App& app, Globals& globals) {
  globals.server = "localhost:50051";
  app.add_option("--server", globals.server, "Address of the server")->envname("LPV_SERVER")->type_name("HOST:PORT");
  app.add_flag("--json", globals.json, "Print results as JSON: one object, or one per line for list and watch");
  app.add_option("--token-file", globals.tokenFile,
                 "File that holds the access token (default: the variable LPV_TOKEN)")
      ->type_name("FILE");
  app.add_option("--ca", globals.ca, "TLS: PEM file of root certificates (default: the system's)")->type_name("FILE");
  app.add_option("--cert", globals.cert, "TLS: PEM file of this client's certificate")->type_name("FILE");
  app.add_option("--key", globals.key, "TLS: PEM file of this client's private key")->type_name("FILE");
  app.add_option("--timeout", globals.timeoutSeconds, "Longest wait for one answer (default: 60)")
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
  std::cerr << "lpvctl: " << visible(line) << " (see lpvctl --help)\n";
  return int(Exit::kUsage);
}

int run(const Globals& globals, const Action& action) {
  Context context(globals);
  Status status;
  try {
    status = action(context);
  } catch (const std::bad_alloc&) {
    status = Status(Code::kResourceExhausted, "not enough memory on this machine");
  }
  if (status.ok()) return int(Exit::kOk);
  if (interrupted()) status = Status(Code::kCancelled, "interrupted");
  std::cerr << "lpvctl: " << visible(describe(status)) << "\n";
  return int(exitFor(status));
}

}  // namespace
}  // namespace lpv::cli

int main(int argc, char** argv) {
  setenv("GRPC_VERBOSITY", "NONE", 0);  // keep gRPC's log off stderr, which gets one line of our own
  lpv::cli::watchInterrupts();
  CLI::App app("Command line of lpvd: create sessions, load scenes, move lights, watch and save what they light.",
               "lpvctl");
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
