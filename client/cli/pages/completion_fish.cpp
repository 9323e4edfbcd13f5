#include "pages/completion.h"
#include "pages/completion_text.h"

namespace lpv::cli {
namespace {

std::string fishQuoted(const std::string& text) { return inQuotes(text, "\\'"); }

std::string fishAt(const CommandInfo& command) {
  return "complete -c lpvctl -n \"__lpvctl_at " + fishQuoted(command.words()) + "\"";
}

std::string fishFlagLines(const CommandInfo& command, bool isRoot) {
  std::string out;
  for (const FlagInfo& flag : command.flags) {
    out += isRoot ? "complete -c lpvctl" : fishAt(command);
    for (const std::string& name : flag.names) {
      out += name.rfind("--", 0) == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1);
    }
    if (!flag.value.empty()) out += flag.takesFile ? " -r -F" : " -x";
    if (!flag.choices.empty()) out += " -a " + fishQuoted(joinedWords(flag.choices, " "));
    out += " -d " + fishQuoted(flag.about) + "\n";
  }
  return out;
}

std::string fishWordLines(const CommandInfo& command) {
  std::string out;
  for (const CommandInfo& each : command.commands) {
    out += fishAt(command) + " -a " + fishQuoted(each.name()) + " -d " + fishQuoted(each.about) + "\n";
  }
  for (const std::string& word : argumentChoices(command)) out += fishAt(command) + " -a " + fishQuoted(word) + "\n";
  return takesFile(command) ? out + fishAt(command) + " -F\n" : out;
}

}  // namespace

std::string fishCompletion(const CommandInfo& root) {
  std::string out =
      "# Completion of lpvctl in fish; written by: lpvctl completion fish\n\n"
      "function __lpvctl_at\n  set -l command lpvctl\n  for word in (commandline -opc)[2..-1]\n"
      "    switch \"$command $word\"\n      case ";
  out += joinedWords(commandPatterns(root), " \\\n        ");
  out +=
      "\n        set command \"$command $word\"\n    end\n  end\n  test $command = $argv[1]\nend\n\n"
      "complete -c lpvctl -f\n";
  out += fishFlagLines(root, true);
  for (const CommandInfo* each : everyCommand(root)) {
    out += fishWordLines(*each);
    if (each != &root) out += fishFlagLines(*each, false);
  }
  return out;
}

}  // namespace lpv::cli
