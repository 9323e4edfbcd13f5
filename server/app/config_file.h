#pragma once

#include <string>
#include <vector>

#include "base/status.h"

namespace lpv::app {

/// A value of a configuration, and where it stands.
struct ConfigEntry {
  std::string name;   ///< with dashes, without the two at the front: "max-sessions"
  std::string value;  ///< without quotes
  std::string where;  ///< "lpvd.toml:3", "LPVD_MAX_SESSIONS"
};

/// "max_sessions" and "max-sessions" are one name.
std::string withDashes(std::string name);

/// Reads lines NAME = VALUE of TOML: numbers, true and false as they are, text in quotes, # before comments. Entries
/// come in the file's order. INVALID_ARGUMENT, with file and line, for sections, anything else, and a name that comes
/// twice.
Expected<std::vector<ConfigEntry>> readConfigFile(const std::string& path);

/// NAME=VALUE as readConfigFile() reads it; text is quoted.
std::string configLine(const std::string& name, const std::string& value);

}  // namespace lpv::app
