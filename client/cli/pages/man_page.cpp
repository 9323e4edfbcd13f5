#include "pages/man_page.h"

#include <algorithm>
#include <cctype>

#include "lpv/client.h"

namespace lpv::cli {
namespace {

/// Text as roff prints it: backslashes and dashes as they are, no line that is a request.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c == '\n' ? ' ' : c;
    }
  }
  return out.empty() || (out[0] != '.' && out[0] != '\'') ? out : "\\&" + out;
}

std::string bold(const std::string& text) { return "\\fB" + roff(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + roff(text) + "\\fR"; }
std::string section(const std::string& title) { return ".SH " + title + "\n"; }
std::string entry(const std::string& term, const std::string& about) { return ".TP\n" + term + "\n" + about + "\n"; }

std::string flagTerm(const FlagInfo& flag) {
  std::string out;
  for (const std::string& name : flag.names) out += (out.empty() ? "" : ", ") + bold(name);
  return flag.value.empty() ? out : out + " " + italic(flag.value);
}

std::string argumentText(const ArgumentInfo& argument) {
  const std::string text = italic(argument.value) + (argument.many ? " ..." : "");
  return argument.required ? text : "[" + text + "]";
}

/// One line: the command, its arguments, the flags that it needs.
std::string synopsis(const CommandInfo& command) {
  std::string out = bold(command.words());
  for (const ArgumentInfo& argument : command.arguments) out += " " + argumentText(argument);
  for (const FlagInfo& flag : command.flags) {
    if (flag.required) out += " " + bold(flag.names.back()) + " " + italic(flag.value);
  }
  if (!command.commands.empty()) return out + " " + italic("COMMAND") + " ...";
  return out + " [" + italic("flags") + "]";
}

std::string argumentsAndFlags(const CommandInfo& command) {
  std::string out;
  for (const ArgumentInfo& argument : command.arguments) out += entry(argumentText(argument), roff(argument.about));
  for (const FlagInfo& flag : command.flags) {
    out += entry(flagTerm(flag), roff(flag.about) + (flag.required ? " (required)" : ""));
  }
  return out;
}

std::string pageName(const CommandInfo& command) { return command.words("-"); }

/// "NAME (1)" with a date of nobody's: pages of one version are the same bytes.
std::string heading(const CommandInfo& command) {
  std::string title = pageName(command);
  std::transform(title.begin(), title.end(), title.begin(), [](unsigned char c) { return char(std::toupper(c)); });
  return ".TH " + roff(title) + " 1 \"\" \"lpvctl " + client::version() + "\" \"lpvd\"\n" + section("NAME") +
         roff(pageName(command)) + " \\- " + roff(command.about) + "\n";
}

std::string commandSections(const CommandInfo& command) {
  std::string out;
  for (const CommandInfo* each : everyCommand(command)) {
    if (!each->commands.empty()) continue;
    if (each != &command)
      out += ".SS " + bold(each->words()) + "\n" + synopsis(*each) + "\n.PP\n" + roff(each->about) + ".\n";
    out += argumentsAndFlags(*each);
  }
  return out;
}

std::string listOfCommands(const CommandInfo& root) {
  std::string out;
  for (const CommandInfo& each : root.commands) {
    out += entry(bold(each.words()), roff(each.about) + ". See " + bold(pageName(each)) + "(1).");
  }
  return out;
}

std::string exitStatus() {
  return section("EXIT STATUS") + entry("0", "Done.") +
         entry("1", "The server refused the call, or a file could not be read or written.") +
         entry("2", "The command line is wrong.") +
         entry("3", "No server answers, or not within \\fB\\-\\-timeout\\fR.") +
         entry("4", "The server asks for a token or certificate, or the one given is not allowed to.") +
         entry("130", "Interrupted.") +
         ".PP\nResults are on stdout, everything else on stderr; with \\fB\\-\\-json\\fR an error is an object with "
         "code, "
         "reason and message.\n";
}

std::string environment() {
  return section("ENVIRONMENT") + entry(bold("LPV_SERVER"), "As \\fB\\-\\-server\\fR.") +
         entry(bold("LPV_TOKEN"), "The access token, where \\fB\\-\\-token\\-file\\fR is not given.") +
         entry(bold("XDG_STATE_HOME"),
               "Where lpvctl keeps who it is in which session, for \\fBlpvctl undo\\fR (default: ~/.local/state).");
}

}  // namespace

std::string manPage(const CommandInfo& root, const CommandInfo& of) {
  std::string out = heading(of) + section("SYNOPSIS") + synopsis(of) + "\n";
  const bool isRoot = &of == &root;
  if (isRoot) {
    out += section("COMMANDS") + listOfCommands(root);
  } else {
    out += section("DESCRIPTION") + roff(of.about) + ".\n" + commandSections(of);
  }
  if (isRoot) return out + section("FLAGS OF ALL COMMANDS") + argumentsAndFlags(root) + exitStatus() + environment();
  return out + section("SEE ALSO") + bold("lpvctl") + "(1) has the flags of all commands and the exit codes.\n";
}

std::vector<std::pair<std::string, std::string>> manPages(const CommandInfo& root) {
  std::vector<std::pair<std::string, std::string>> out{{pageName(root) + ".1", manPage(root, root)}};
  for (const CommandInfo& each : root.commands) out.emplace_back(pageName(each) + ".1", manPage(root, each));
  return out;
}

}  // namespace lpv::cli
