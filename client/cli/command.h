#pragma once
// What all commands of lpvctl share: global flags, the connection, exit codes, warnings.

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "lpv/client.h"

namespace lpv::cli {

/// Exit codes; scripts rely on them.
enum class Exit : int {
  kOk = 0,
  kRefused = 1,        ///< the server refused the call, or a file could not be read or written
  kUsage = 2,
  kUnreachable = 3,    ///< no server answers, or not within the timeout
  kNotAuthorised = 4,
  kInterrupted = 130,  ///< Ctrl-C: 128 + SIGINT, as in shells
};

Exit exitFor(const Status& status);

/// The code of what went wrong on this machine, without a server: it has no name of the wire, whose 2, UNKNOWN, no
/// server answers.
inline constexpr Code kLocal = Code(2);
/// An error of that code at `field`, and `status` as one.
Status localError(std::string field, std::string message);
Status asLocal(const Status& status);
template <typename T>
Expected<T> asLocal(Expected<T> value) {
  if (value) return value;
  return asLocal(value.status());
}

/// "CODE: message (field)" in one line; without the code for what went wrong here.
std::string describe(const Status& status);

/// One line on stderr: with `json` an object with code, reason, message and field. Codes beside the wire's: LOCAL, and
/// USAGE for a command line that cannot be carried out.
void printError(const Status& status, bool json);
void printUsageError(const std::string& message, bool json);

/// The value of --ca for the roots of this machine.
inline constexpr const char* kSystemRoots = "system";

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

/// What a running command works with.
class Context {
 public:
  explicit Context(Globals globals) : globals_(std::move(globals)) {}

  bool json() const { return globals_.json; }
  const Globals& globals() const { return globals_; }
  /// Prepares a connection whose calls are cancelled by Ctrl-C.
  Expected<client::Client> connect() const;
  /// A connection that Ctrl-C does not cancel, for cleaning up afterwards; calls time out after 5 s.
  Expected<client::Client> connectForCleanup() const;

 private:
  client::ConnectOptions options() const;
  Globals globals_;
};

using Action = std::function<Status(Context&)>;

/// Collects the commands while they are declared and remembers which one was chosen.
class Commands {
 public:
  /// Declares a group of commands ("session").
  static CLI::App& group(CLI::App& parent, const std::string& name, const std::string& about);
  /// Declares a command. `action` runs after the whole command line has been parsed.
  CLI::App& add(CLI::App& parent, const std::string& name, const std::string& about, Action action);
  const Action& chosen() const { return chosen_; }

 private:
  Action chosen_;
};

/// Adds the positional session id, the first argument of most commands.
void addSession(CLI::App& command, std::string& session);

/// Makes it a usage error to give none of the command's flags.
void requireSomeFlag(CLI::App& command);

/// Prints "lpvctl: warning: ..." on stderr.
void warn(const std::string& message);
/// Says on stderr what was assumed.
void note(const std::string& message);
/// From now on warnings and notes are objects {"warning": ...} and {"note": ...}, so that all of stderr is JSON.
void setJsonMessages(bool json);

/// Ends an action as a usage error, exit code 2: for what only shows when the whole command line is known.
[[noreturn]] void failUsage(const std::string& command, const std::string& message);

// The commands; one function per file.
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
void addHelpCommands(CLI::App& app, Commands& commands);

}  // namespace lpv::cli
