#pragma once
// The commands of lpvctl as values, read from CLI11's tree: what manual pages and completions are made from.

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace lpv::cli {

struct FlagInfo {
  std::vector<std::string> names;    ///< as typed: "-o", "--output"
  std::string value;                 ///< how help calls its value, "r,g,b"; empty: it takes none
  std::string about;
  bool required = false;
  bool takesFile = false;
  std::vector<std::string> choices;  ///< words that the value may be
};

struct ArgumentInfo {
  std::string value;  ///< "ID", "FILE"
  std::string about;
  bool required = false;
  bool many = false;
  bool takesFile = false;
  std::vector<std::string> choices;
};

struct CommandInfo {
  std::vector<std::string> path;  ///< "lpvctl", "light", "add"
  std::string about;
  std::vector<FlagInfo> flags;    ///< its own; those of "lpvctl" work everywhere
  std::vector<ArgumentInfo> arguments;
  std::vector<CommandInfo> commands;

  const std::string& name() const { return path.back(); }
  /// The path as typed, or joined by something else.
  std::string words(const std::string& between = " ") const;
};

CommandInfo describeCommands(const CLI::App& app);

/// The command and all below it, parents first.
std::vector<const CommandInfo*> everyCommand(const CommandInfo& root);

}  // namespace lpv::cli
