#include "pages/completion.h"
#include "pages/completion_text.h"

namespace lpv::cli {
namespace {

/// "COMMAND:FLAG" of each of the command's flags with a value; those of the root are for every command.
std::string bashValueCases(const CommandInfo& command, bool isRoot) {
  std::string out;
  for (const FlagInfo& flag : command.flags) {
    if (flag.value.empty()) continue;
    std::vector<std::string> patterns;
    for (const std::string& name : flag.names) {
      patterns.push_back(isRoot ? "*" + inQuotes(":" + name) : inQuotes(command.words() + ":" + name));
    }
    out += "    " + joinedWords(patterns, " | ") + ") ";
    if (flag.takesFile) out += "files=yes ";
    out += "words=" + inQuotes(joinedWords(flag.choices, " ")) + " ;;\n";
  }
  return out;
}

std::string bashWordCase(const CommandInfo& command, const CommandInfo& root) {
  std::vector<std::string> flags, words;
  for (const CommandInfo* of : {&command, &root}) {
    for (const FlagInfo& flag : of->flags) flags.insert(flags.end(), flag.names.begin(), flag.names.end());
    if (&command == &root) break;
  }
  for (const CommandInfo& each : command.commands) words.push_back(each.name());
  for (const std::string& word : argumentChoices(command)) words.push_back(word);
  std::string out = "      " + inQuotes(command.words()) + ") flags=" + inQuotes(joinedWords(flags, " "));
  out += " words=" + inQuotes(joinedWords(words, " "));
  return out + (takesFile(command) ? " files=yes" : "") + " ;;\n";
}

}  // namespace

std::string bashCompletion(const CommandInfo& root) {
  std::string out =
      "# Completion of lpvctl in bash; written by: lpvctl completion bash\n\n_lpvctl() {\n"
      "  local current=${COMP_WORDS[COMP_CWORD]} command=lpvctl flags='' words='' files=no i\n"
      "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
      "    case \"$command ${COMP_WORDS[i]}\" in\n      ";
  out += joinedWords(commandPatterns(root), " | \\\n      ");
  out +=
      ") command+=\" ${COMP_WORDS[i]}\" ;;\n    esac\n  done\n"
      "  case \"$command:${COMP_WORDS[COMP_CWORD - 1]}\" in\n";
  for (const CommandInfo* each : everyCommand(root)) {
    if (each != &root) out += bashValueCases(*each, false);
  }
  out += bashValueCases(root, true);
  out += "    *) case $command in\n";
  for (const CommandInfo* each : everyCommand(root)) out += bashWordCase(*each, root);
  out +=
      "    esac ;;\n  esac\n"
      "  [[ $current != -* ]] || words=$flags\n"
      "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")\n"
      "  if [[ $files == yes && $current != -* ]]; then\n"
      "    compopt -o filenames 2>/dev/null\n"
      "    mapfile -t -O \"${#COMPREPLY[@]}\" COMPREPLY < <(compgen -f -- \"$current\")\n"
      "  fi\n}\n\ncomplete -F _lpvctl lpvctl\n";
  return out;
}

}  // namespace lpv::cli
