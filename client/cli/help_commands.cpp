// help | man | completion

#include <filesystem>
#include <iostream>
#include <memory>

#include "command.h"
#include "files.h"
#include "pages/command_tree.h"
#include "pages/completion.h"
#include "pages/man_page.h"
#include "spelling.h"
#include "values.h"

namespace lpv::cli {
namespace {

using Words = std::vector<std::string>;

/// Adds the words of a command as arguments. That they name none is a usage error with the nearest.
void addCommandWords(CLI::App& app, const CLI::App& root, const std::shared_ptr<Words>& words, const char* about) {
  app.add_option("command", *words, about)->type_name("COMMAND");
  app.parse_complete_callback([&root, words] {
    const FoundCommand found = findCommand(root, *words);
    if (!found.badWord.empty()) failUsage("", unknownCommand(*found.command, found.path, found.badWord));
  });
}

void addHelp(CLI::App& root, Commands& commands) {
  auto words = std::make_shared<Words>();
  CLI::App& app = commands.add(root, "help", "Print the help of lpvctl or of a command", [&root, words](Context&) {
    const FoundCommand found = findCommand(root, *words);
    const std::size_t last = found.path.rfind(' ');
    // CLI11 would print the help of the command that was parsed, which is this one, were the root asked.
    if (last != std::string::npos) {
      std::cout << found.command->help(found.path.substr(0, last));
    } else {
      std::cout << root.get_formatter()->make_help(&root, root.get_name(), CLI::AppFormatMode::Normal);
    }
    std::cout.flush();
    return Status();
  });
  addCommandWords(app, root, words, "The command (default: all of them)");
}

/// The info of the command that was found.
const CommandInfo& infoOf(const CommandInfo& root, const Words& words) {
  const CommandInfo* at = &root;
  for (const std::string& word : words) {
    for (const CommandInfo& each : at->commands) {
      if (each.name() != word) continue;
      at = &each;
      break;
    }
  }
  return *at;
}

Status writePages(const CommandInfo& root, const std::string& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  for (const auto& [name, page] : manPages(root)) {
    if (Status status = writeFile(directory + "/" + name, page); !status.ok()) return status;
  }
  return {};
}

void addMan(CLI::App& root, Commands& commands) {
  auto words = std::make_shared<Words>();
  auto directory = std::make_shared<std::string>();
  CLI::App& app = commands.add(root, "man", "Print the manual page of lpvctl or of a command, for man -l -",
                               [&root, words, directory](Context&) -> Status {
                                 const CommandInfo info = describeCommands(root);
                                 if (!directory->empty()) return writePages(info, *directory);
                                 std::cout << manPage(info, infoOf(info, *words));
                                 std::cout.flush();
                                 return {};
                               });
  addCommandWords(app, root, words, "The command (default: lpvctl itself)");
  app.add_option("--directory", *directory, "Write all pages into this folder instead: lpvctl.1, lpvctl-light.1 ...")
      ->type_name("DIR");
}

enum class Shell { kBash, kZsh, kFish };

std::string completionFor(Shell shell, const CommandInfo& info) {
  switch (shell) {
    case Shell::kBash:
      return bashCompletion(info);
    case Shell::kZsh:
      return zshCompletion(info);
    case Shell::kFish:
      return fishCompletion(info);
  }
  return {};
}

void addCompletion(CLI::App& root, Commands& commands) {
  struct Options {
    std::optional<Shell> shell;
    std::string out = kStandardStream;
  };
  auto given = std::make_shared<Options>();
  CLI::App& app = commands.add(
      root, "completion", "Print the completion of lpvctl's command line for a shell",
      [&root, given](Context&) { return writeFile(given->out, completionFor(*given->shell, describeCommands(root))); });
  addChoice<Shell>(app, "shell", given->shell, {{"bash", Shell::kBash}, {"zsh", Shell::kZsh}, {"fish", Shell::kFish}},
                   "The shell: source <(lpvctl completion bash), for example")
      ->required();
  app.add_option("-o,--output", given->out, "File to write (default: stdout)")->type_name("FILE");
}

}  // namespace

void addHelpCommands(CLI::App& app, Commands& commands) {
  addHelp(app, commands);
  addMan(app, commands);
  addCompletion(app, commands);
}

}  // namespace lpv::cli
