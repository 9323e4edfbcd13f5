#pragma once
// What the completions of the three shells share: words in quotes, and lists of them.

#include <string>
#include <vector>

#include "pages/command_tree.h"

namespace lpv::cli {

/// A word in single quotes; `escapedQuote`: how the shell writes one inside.
inline std::string inQuotes(const std::string& text, const std::string& escapedQuote = "'\\''") {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? escapedQuote : std::string(1, c);
  return out + "'";
}

inline std::string joinedWords(const std::vector<std::string>& words, const std::string& between) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : between) + word;
  return out;
}

/// Every command below the root as a quoted pattern: 'lpvctl light', 'lpvctl light add' ...
inline std::vector<std::string> commandPatterns(const CommandInfo& root) {
  std::vector<std::string> out;
  for (const CommandInfo* each : everyCommand(root)) {
    if (each != &root) out.push_back(inQuotes(each->words()));
  }
  return out;
}

/// Whether one of the command's arguments is a file.
inline bool takesFile(const CommandInfo& command) {
  for (const ArgumentInfo& argument : command.arguments) {
    if (argument.takesFile) return true;
  }
  return false;
}

/// The words that the command's arguments may be.
inline std::vector<std::string> argumentChoices(const CommandInfo& command) {
  std::vector<std::string> out;
  for (const ArgumentInfo& argument : command.arguments) {
    out.insert(out.end(), argument.choices.begin(), argument.choices.end());
  }
  return out;
}

}  // namespace lpv::cli
