#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/config_file.h"

namespace lpv::app {

/// What was asked for, from everywhere: flags over environment over file.
struct Sources {
  std::vector<std::string> flags;    ///< of the command line, without the program; names with dashes
  std::vector<ConfigEntry> entries;  ///< of environment and file, without those that a flag or the environment replaces
  std::string ignored;  ///< names of LPVD_* variables that are no options of ours: "LPVD_PORT, LPVD_X"

  /// All in one command line, without the program.
  std::vector<std::string> arguments() const;
  /// Where the value of a flag stands that was not on the command line; empty where it was.
  std::string placeOf(const std::string& name) const;
};

/// `known` says whether a name, with dashes, is an option that files and variables can set. An unknown name in the file
/// is INVALID_ARGUMENT, with its line; unknown variables are ignored, since others set such: Kubernetes LPVD_PORT and
/// LPVD_SERVICE_HOST for a service "lpvd". Empty values are none.
Expected<Sources> gatherSources(int argc, char** argv, const std::function<bool(const std::string&)>& known);

/// "max-sessions" is set by LPVD_MAX_SESSIONS.
std::string variableOf(const std::string& name);

}  // namespace lpv::app
