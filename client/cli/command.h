#pragma once
// What every command of lpvctl shares: the global flags, the connection, the result's way to stdout, the exit code.

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "lpv/client.h"

namespace lpv::cli {

/// Exit codes of the contract.
enum class Exit : int {
  kOk = 0,
  kRefused = 1,        ///< the server, or a file, said no
  kUsage = 2,
  kUnreachable = 3,    ///< nobody answers, or not in time
  kNotAuthorised = 4,
  kInterrupted = 130,  ///< Ctrl-C, as shells count it
};

Exit exitFor(const Status& status);

/// "CODE: message (field)" in one line.
std::string describe(const Status& status);

/// Global flags.
struct Globals {
  std::string server;
  bool json = false;
  std::string tokenFile;
  std::string ca;
  std::string cert;
  std::string key;
  double timeoutSeconds = 60.0;
};

/// A running command's surroundings.
class Context {
 public:
  explicit Context(Globals globals) : globals_(std::move(globals)) {}

  bool json() const { return globals_.json; }
  /// Prepares the connection; its calls end when the process is interrupted.
  Expected<client::Client> connect() const;
  /// A connection that an interruption does not end: for cleaning up.
  Expected<client::Client> connectForCleanup() const;

 private:
  client::ConnectOptions options() const;
  Globals globals_;
};

using Action = std::function<Status(Context&)>;

/// Collects the commands while they are declared and remembers which one was chosen.
class Commands {
 public:
  /// A group: a word before the command ("session").
  static CLI::App& group(CLI::App& parent, const std::string& name, const std::string& about);
  /// A command. `action` runs after the whole command line has been understood.
  CLI::App& add(CLI::App& parent, const std::string& name, const std::string& about, Action action);
  const Action& chosen() const { return chosen_; }

 private:
  Action chosen_;
};

/// Adds the positional session id, the first word of most commands.
void addSession(CLI::App& command, std::string& session);

/// A usage error unless at least one of the command's flags is given.
void requireSomeFlag(CLI::App& command);

/// "lpvctl: warning: ..." on stderr.
void warn(const std::string& message);

// The commands, a group per file.
void addSessionCommands(CLI::App& app, Commands& commands);
void addSceneCommands(CLI::App& app, Commands& commands);
void addLightCommands(CLI::App& app, Commands& commands);
void addSurfaceCommands(CLI::App& app, Commands& commands);
void addHistoryCommands(CLI::App& app, Commands& commands);
void addPickCommand(CLI::App& app, Commands& commands);
void addVolumeCommands(CLI::App& app, Commands& commands);
void addProbeCommand(CLI::App& app, Commands& commands);
void addFrameCommands(CLI::App& app, Commands& commands);
void addWatchCommand(CLI::App& app, Commands& commands);
void addRenderCommand(CLI::App& app, Commands& commands);
void addServerCommands(CLI::App& app, Commands& commands);

}  // namespace lpv::cli
