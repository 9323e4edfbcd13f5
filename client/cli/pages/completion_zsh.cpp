#include "pages/completion.h"
#include "pages/completion_text.h"

namespace lpv::cli {
namespace {

/// 'NAME:WHAT IT DOES', as _describe takes it.
std::string zshDescribed(const std::string& name, const std::string& about) { return inQuotes(name + ":" + about); }

std::vector<std::string> zshFlagWords(const CommandInfo& command) {
  std::vector<std::string> out;
  for (const FlagInfo& flag : command.flags) {
    for (const std::string& name : flag.names) out.push_back(zshDescribed(name, flag.about));
  }
  return out;
}

std::string zshValueCases(const CommandInfo& command, bool isRoot) {
  std::string out;
  for (const FlagInfo& flag : command.flags) {
    if (flag.value.empty()) continue;
    std::vector<std::string> patterns;
    for (const std::string& name : flag.names) {
      patterns.push_back(isRoot ? "*" + inQuotes(":" + name) : inQuotes(command.words() + ":" + name));
    }
    out += "    (" + joinedWords(patterns, "|") + ")\n      _message " + inQuotes(flag.value) + "\n";
    if (!flag.choices.empty()) out += "      compadd -- " + joinedWords(flag.choices, " ") + "\n";
    if (flag.takesFile) out += "      _files\n";
    out += "      return ;;\n";
  }
  return out;
}

std::string zshWordCase(const CommandInfo& command) {
  std::vector<std::string> commands;
  for (const CommandInfo& each : command.commands) commands.push_back(zshDescribed(each.name(), each.about));
  for (const std::string& word : argumentChoices(command)) commands.push_back(inQuotes(word));
  std::string out = "    (" + inQuotes(command.words()) + ")\n";
  if (!commands.empty()) out += "      commands=(" + joinedWords(commands, "\n        ") + ")\n";
  out += "      flags+=(" + joinedWords(zshFlagWords(command), "\n        ") + ")\n";
  return out + (takesFile(command) ? "      files=yes\n" : "") + "      ;;\n";
}

}  // namespace

std::string zshCompletion(const CommandInfo& root) {
  std::string out =
      "#compdef lpvctl\n# Completion of lpvctl in zsh; written by: lpvctl completion zsh\n\n_lpvctl() {\n"
      "  local command=lpvctl files=no i\n  local -a commands flags\n"
      "  for ((i = 2; i < CURRENT; i++)); do\n    case \"$command ${words[i]}\" in\n      (";
  out += joinedWords(commandPatterns(root), "|\\\n      ");
  out += ") command+=\" ${words[i]}\" ;;\n    esac\n  done\n  case \"$command:${words[CURRENT - 1]}\" in\n";
  for (const CommandInfo* each : everyCommand(root)) {
    if (each != &root) out += zshValueCases(*each, false);
  }
  out += zshValueCases(root, true) + "  esac\n";
  out += "  [[ $command == lpvctl ]] || flags=(" + joinedWords(zshFlagWords(root), "\n        ") + ")\n";
  out += "  case $command in\n";
  for (const CommandInfo* each : everyCommand(root)) out += zshWordCase(*each);
  out +=
      "  esac\n"
      "  if [[ ${words[CURRENT]} == -* ]]; then\n    _describe -o 'flag' flags\n    return\n  fi\n"
      "  (( ! ${#commands} )) || _describe 'command' commands\n"
      "  [[ $files == no ]] || _files\n}\n\n"
      "if [[ ${funcstack[1]} == _lpvctl ]]; then\n  _lpvctl \"$@\"\nelse\n  compdef _lpvctl lpvctl\nfi\n";
  return out;
}

}  // namespace lpv::cli
