#include "pages/command_tree.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace lpv::cli {
namespace {

/// The name of the option's value without what CLI11 adds of its checks: "SECONDS" of "SECONDS:FLOAT in [0.001 - 9]".
std::string valueOf(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return {};
  const std::string text = option.get_type_name();
  std::size_t end = text.size();
  for (const char* check : {":FLOAT in", ":INT in", ":{", ":value in"}) end = std::min(end, text.find(check));
  return text.substr(0, end);
}

bool isFile(const std::string& value) {
  constexpr std::array kWords = {"FILE", "OUT", "IMG", "DIR"};
  return std::any_of(kWords.begin(), kWords.end(),
                     [&](const char* word) { return value.find(word) != std::string::npos; });
}

/// The words among the alternatives of a value: "auto" of "N|auto". Forms of numbers ("v|r,g,b") have none.
std::vector<std::string> choicesOf(const std::string& value) {
  std::vector<std::string> words;
  if (value.find('|') == std::string::npos || value.find(',') != std::string::npos) return words;
  for (std::size_t begin = 0; begin <= value.size();) {
    const std::size_t end = std::min(value.find('|', begin), value.size());
    const std::string word = value.substr(begin, end - begin);
    const bool isWord = std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isupper(c) == 0; });
    if (isWord) words.push_back(word);
    begin = end + 1;
  }
  return words;
}

FlagInfo flagInfo(const CLI::Option& option) {
  FlagInfo out;
  for (const std::string& name : option.get_snames()) out.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) out.names.push_back("--" + name);
  out.value = valueOf(option);
  out.about = option.get_description();
  out.required = option.get_required();
  out.takesFile = isFile(out.value);
  out.choices = choicesOf(out.value);
  return out;
}

ArgumentInfo argumentInfo(const CLI::Option& option) {
  const std::string value = valueOf(option);
  return {value,         option.get_description(), option.get_required(), option.get_items_expected_max() > 1,
          isFile(value), choicesOf(value)};
}

CommandInfo commandInfo(const CLI::App& app, std::vector<std::string> path) {
  CommandInfo out;
  path.push_back(app.get_name());
  out.path = path;
  out.about = app.get_description();
  for (const CLI::Option* option : app.get_options()) {
    if (option == app.get_help_ptr() && path.size() > 1) continue;  // the root's, in every command
    if (option->get_positional()) {
      out.arguments.push_back(argumentInfo(*option));
    } else {
      out.flags.push_back(flagInfo(*option));
    }
  }
  for (const CLI::App* each : app.get_subcommands({})) out.commands.push_back(commandInfo(*each, path));
  return out;
}

}  // namespace

std::string CommandInfo::words(const std::string& between) const {
  std::string out;
  for (const std::string& word : path) out += (out.empty() ? "" : between) + word;
  return out;
}

CommandInfo describeCommands(const CLI::App& app) { return commandInfo(app, {}); }

std::vector<const CommandInfo*> everyCommand(const CommandInfo& root) {
  std::vector<const CommandInfo*> out{&root};
  for (const CommandInfo& each : root.commands) {
    const std::vector<const CommandInfo*> below = everyCommand(each);
    out.insert(out.end(), below.begin(), below.end());
  }
  return out;
}

}  // namespace lpv::cli
