#include "spelling.h"

#include <algorithm>
#include <cctype>

namespace lpv::cli {
namespace {

std::vector<std::string> commandsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* each : app.get_subcommands({})) names.push_back(each->get_name());
  return names;
}

const CLI::App* commandOf(const CLI::App& app, const std::string& name) {
  for (const CLI::App* each : app.get_subcommands({})) {
    if (each->get_name() == name) return each;
  }
  return nullptr;
}

/// The names of all flags that the command takes, its parents' too: "--json", "-o".
std::vector<std::string> flagsOf(const CLI::App* app) {
  std::vector<std::string> names;
  for (; app != nullptr; app = app->get_parent()) {
    for (const CLI::Option* option : app->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
      for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
  }
  return names;
}

const CLI::Option* flagOf(const CLI::App* app, const std::string& name) {
  for (; app != nullptr; app = app->get_parent()) {
    for (const CLI::Option* option : app->get_options()) {
      if (!option->get_positional() && option->check_name(name)) return option;
    }
  }
  return nullptr;
}

/// Whether the word is read as a flag: "-" is a file, "-1,2" a value.
bool isFlag(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && word[1] != '.' && std::isdigit(static_cast<unsigned char>(word[1])) == 0;
}

std::string suggestion(const std::string& word, const std::vector<std::string>& candidates) {
  const std::optional<std::string> close = nearest(word, candidates);
  return close ? "; did you mean '" + *close + "'?" : "";
}

std::string listed(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

std::string unknownFlag(const CLI::App* app, const std::string& path, const std::string& name) {
  return path + " has no flag '" + name + "'" + suggestion(name, flagsOf(app));
}

}  // namespace

std::size_t editDistance(const std::string& from, const std::string& to) {
  std::vector<std::vector<std::size_t>> cost(from.size() + 1, std::vector<std::size_t>(to.size() + 1));
  for (std::size_t i = 0; i <= from.size(); ++i) cost[i][0] = i;
  for (std::size_t j = 0; j <= to.size(); ++j) cost[0][j] = j;
  for (std::size_t i = 1; i <= from.size(); ++i) {
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t replaced = cost[i - 1][j - 1] + (from[i - 1] == to[j - 1] ? 0 : 1);
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, replaced});
      const bool exchanged = i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1];
      if (exchanged) cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  }
  return cost[from.size()][to.size()];
}

std::optional<std::string> nearest(const std::string& word, const std::vector<std::string>& candidates) {
  std::optional<std::string> best;
  std::size_t fewest = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t edits = editDistance(word, candidate);
    if (edits >= fewest || edits >= candidate.size()) continue;
    fewest = edits;
    best = candidate;
  }
  return best;
}

std::string unknownCommand(const CLI::App& where, const std::string& path, const std::string& word) {
  const std::vector<std::string> names = commandsOf(where);
  if (names.empty()) return path + " has no commands of its own: '" + word + "' names none";
  const std::string close = suggestion(word, names);
  return path + " has no command '" + word + "'" + (close.empty() ? "; it has " + listed(names) : close);
}

FoundCommand findCommand(const CLI::App& app, const std::vector<std::string>& words) {
  FoundCommand found{&app, app.get_name(), ""};
  for (const std::string& word : words) {
    const CLI::App* next = commandOf(*found.command, word);
    if (next == nullptr) {
      found.badWord = word;
      return found;
    }
    found.command = next;
    found.path += " " + word;
  }
  return found;
}

std::string misspelling(const CLI::App& app, const std::vector<std::string>& arguments) {
  const CLI::App* at = &app;
  std::string path = app.get_name();
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    if (word == "--") return {};
    if (isFlag(word)) {
      const bool isLong = word[1] == '-';
      const std::string name = isLong ? word.substr(0, word.find('=')) : word.substr(0, 2);
      const CLI::Option* option = flagOf(at, name);
      if (option == nullptr) return unknownFlag(at, path, isLong ? name : word);
      const bool valueFollows = isLong ? word.size() == name.size() : word.size() == 2;
      if (valueFollows && option->get_items_expected_max() > 0) ++i;
    } else if (const CLI::App* next = commandOf(*at, word); next != nullptr) {
      at = next;
      path += " " + word;
    } else if (!commandsOf(*at).empty()) {
      return unknownCommand(*at, path, word);
    }
  }
  return {};
}

}  // namespace lpv::cli
