#pragma once
// What of a command line is no command or flag, and what it was probably meant to be.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace lpv::cli {

/// Edits (insert, delete, replace, exchange of neighbours) that make one word of the other.
std::size_t editDistance(const std::string& from, const std::string& to);

/// The candidate with the fewest edits to `word`, the first of several; none where that is more than a third of its
/// letters, two at least.
std::optional<std::string> nearest(const std::string& word, const std::vector<std::string>& candidates);

/// The command that `words` name ("light", "add"), as far as they name one; `app` itself for none.
struct FoundCommand {
  const CLI::App* command = nullptr;
  std::string path;      ///< "lpvctl light"
  std::string badWord;   ///< the first word that names no command there; empty: all do
};
FoundCommand findCommand(const CLI::App& app, const std::vector<std::string>& words);

/// A sentence about a word that names no command of `where`, with the nearest.
std::string unknownCommand(const CLI::App& where, const std::string& path, const std::string& word);

/// A sentence about the first word or flag of a command line that is unknown, with the nearest; empty where all are
/// known.
std::string misspelling(const CLI::App& app, const std::vector<std::string>& arguments);

}  // namespace lpv::cli
