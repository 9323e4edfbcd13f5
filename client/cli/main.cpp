// lpvctl: the command line of lpv.v1.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "command.h"
#include "connection_help.h"
#include "interrupt.h"
#include "spelling.h"

namespace lpv::cli {
namespace {

void addGlobals(CLI::App& app, Globals& globals) {
  globals.server = "localhost:50051";
  app.add_option("--server", globals.server, "Address of the server")->envname("LPV_SERVER")->type_name("HOST:PORT");
  app.add_flag("--json", globals.json,
               "Print results as JSON: one object, or one per line for list and watch; errors too, on stderr");
  app.add_option("--token-file", globals.tokenFile,
                 "File that holds the access token (default: the variable LPV_TOKEN)")
      ->type_name("FILE");
  app.add_option("--ca", globals.ca,
                 "TLS: PEM file of root certificates, or system for those of this machine (default: no TLS)")
      ->type_name("FILE|system");
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
  addHelpCommands(app, commands);
}

/// The command that was parsed as far as it was: "lpvctl light".
std::string parsedPath(const CLI::App& app) {
  const std::vector<CLI::App*> parsed = app.get_subcommands();
  return app.get_name() + (parsed.empty() ? "" : " " + parsedPath(*parsed.front()));
}

int usage(const CLI::App& app, const CLI::ParseError& error, const std::vector<std::string>& arguments) {
  if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
  std::string line = misspelling(app, arguments);
  if (line.empty()) line = error.what();
  if (line.rfind(": ", 0) == 0) line.erase(0, 2);
  line = line.substr(0, line.find('\n')) + " (see " + parsedPath(app) + " --help)";
  // The command line could not be read to its end: --json may stand anywhere.
  const auto end = std::find(arguments.begin(), arguments.end(), "--");
  printUsageError(line, std::find(arguments.begin(), end, "--json") != end);
  return int(Exit::kUsage);
}

int run(const Globals& globals, const Action& action) {
  Context context(globals);
  setJsonMessages(globals.json);
  Status status;
  try {
    status = action(context);
  } catch (const std::bad_alloc&) {
    status = localError("", "not enough memory on this machine");
  }
  if (status.ok()) return int(Exit::kOk);
  if (interrupted()) status = Status(Code::kCancelled, "interrupted");
  if (status.code() == Code::kUnavailable) status = withConnectionHelp(status, globals);
  printError(status, globals.json);
  return int(exitFor(status));
}

}  // namespace
}  // namespace lpv::cli

int main(int argc, char** argv) {
  setenv("GRPC_VERBOSITY", "NONE", 0);  // keep gRPC's log off stderr, which gets one line of our own
  lpv::cli::watchInterrupts();
  CLI::App app("Command line of lpvd: create sessions, load scenes, move lights, watch and save what they light.",
               "lpvctl");
  app.set_version_flag("--version", std::string("lpvctl ") + lpv::client::version(), "Print lpvctl's version and exit");
  app.require_subcommand(1);
  app.fallthrough();
  lpv::cli::Globals globals;
  lpv::cli::Commands commands;
  lpv::cli::addGlobals(app, globals);
  lpv::cli::addCommands(app, commands);
  try {
    app.parse(argc, argv);
    return lpv::cli::run(globals, commands.chosen());
  } catch (const CLI::ParseError& error) {
    return lpv::cli::usage(app, error, {argv + std::min(argc, 1), argv + argc});
  }
}
