// What lpvctl says of itself: help, version, manual pages, completions. The shells and man judge them.

#include <gmock/gmock.h>

#include <filesystem>
#include <string>

#include "rpc/cli/cli_files.h"
#include "rpc/cli/cli_run.h"

namespace lpv::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

Outcome offline(std::vector<std::string> arguments) { return runLpvctl(std::move(arguments)); }

/// A command of bash, in which $LPVCTL is the program.
std::string bash(const std::string& command) {
  rpc::ChildProcess shell("/bin/bash", {"-c", "set -euo pipefail; LPVCTL=" LPVCTL_PATH "; " + command});
  EXPECT_EQ(shell.wait(), 0) << command << "\n" << shell.output() << shell.errors();
  EXPECT_EQ(shell.errors(), "") << command;
  return shell.output();
}

TEST(Pages, TheVersionNeedsNoServer) {
  const Outcome version = offline({"--version"});
  EXPECT_EQ(version.exit, 0);
  EXPECT_THAT(version.out, testing::MatchesRegex("lpvctl [0-9]+[.][0-9]+[.][0-9]+\n"));
}

TEST(Pages, HelpOfACommandIsThatOfItsFlag) {
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{}, {"light"}, {"light", "add"}, {"render"}, {"help"}}) {
    std::vector<std::string> asked = {"help"}, flag = command;
    asked.insert(asked.end(), command.begin(), command.end());
    flag.push_back("--help");
    const Outcome help = offline(asked);
    EXPECT_EQ(help.exit, 0) << help.err;
    EXPECT_EQ(help.out, offline(flag).out);
  }
  EXPECT_THAT(offline({"help", "light", "add"}).out, AllOf(HasSubstr("lpvctl light add"), HasSubstr("--radiance")));
  const Outcome wrong = offline({"help", "lihgt", "add"});
  EXPECT_EQ(wrong.exit, 2);
  EXPECT_THAT(wrong.err, StartsWith("lpvctl: lpvctl has no command 'lihgt'; did you mean 'light'?"));
}

// Broken by: a line that begins with a dot; a dash that is not escaped; a flag that is left out.
TEST(Pages, ManReadsEveryPage) {
  const TemporaryFolder folder;
  EXPECT_EQ(offline({"man", "--directory", folder.path("man1")}).exit, 0);
  std::size_t pages = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder.path("man1"))) {
    ++pages;
    const std::string shown =
        bash("LC_ALL=C.UTF-8 MANWIDTH=100 MANROFFOPT=-ww man -E UTF-8 -l " + file.path().string());
    EXPECT_THAT(shown, AllOf(HasSubstr("NAME"), HasSubstr("SYNOPSIS"), HasSubstr("lpvctl"))) << file.path();
  }
  EXPECT_GE(pages, 15U);
  const auto page = [&](const std::string& command) {
    return bash("$LPVCTL man " + command + " | LC_ALL=C.UTF-8 MANWIDTH=200 man -E UTF-8 -l -");
  };
  const std::string light = page("light");
  for (const char* words : {"lpvctl light add ID MESHFILE", "lpvctl light move ID NAME", "--radiance v|r,g,b",
                            "--two-sided", "lpvctl light remove ID NAME ..."}) {
    EXPECT_THAT(light, HasSubstr(words));
  }
  EXPECT_THAT(page(""), AllOf(HasSubstr("EXIT STATUS"), HasSubstr("--token-file FILE"), HasSubstr("lpvctl render"),
                              HasSubstr("LPV_SERVER")));
  EXPECT_THAT(page("frame get"), HasSubstr("-o, --output OUT"));
  EXPECT_EQ(offline({"man", "nothing"}).exit, 2);
}

// Broken by: words of another command; no words for a flag's value.
TEST(Pages, BashCompletes) {
  const auto completed = [](const std::string& words) {
    return bash("set +e; source <($LPVCTL completion bash); complete -p lpvctl >/dev/null; cd " LPVCTL_FOLDER
                "; COMP_WORDS=(" +
                words +
                "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _lpvctl; "
                "printf '%s\\n' \"${COMPREPLY[@]}\"");
  };
  EXPECT_EQ(completed("lpvctl rend"), "render\n");
  EXPECT_EQ(completed("lpvctl light m"), "move\n");
  EXPECT_EQ(completed("lpvctl --json light m"), "move\n");
  EXPECT_THAT(completed("lpvctl light add room --ra"), "--radiance\n");
  EXPECT_THAT(completed("lpvctl light add room --ser"), "--server\n");
  EXPECT_EQ(completed("lpvctl session create --transport g"), "gather\n");
  EXPECT_EQ(completed("lpvctl render --transport d"), "direct\n");
  EXPECT_EQ(completed("lpvctl completion z"), "zsh\n");
  EXPECT_EQ(completed("lpvctl render lpvc"), "lpvctl\n") << "a file";
  EXPECT_EQ(completed("lpvctl stats --ca lpvc"), "lpvctl\n") << "a file";
  EXPECT_EQ(completed("lpvctl session show lpvc"), "\n") << "no file";
  EXPECT_EQ(completed("lpvctl completion fi"), "fish\n");
}

// The functions that show completions are replaced by ones that print them. Broken by: the same.
TEST(Pages, ZshCompletes) {
  const auto completed = [](const std::string& words) {
    return bash(
        "zsh -f -c 'autoload -U compinit && compinit -D -u; source <(" LPVCTL_PATH
        " completion zsh); [[ $_comps[lpvctl] == _lpvctl ]] || exit 1; "
        "_describe() { local name=${@[-1]}; print -l -- \"${(@P)name}\" }; compadd() { shift; print -l -- \"$@\" }; "
        "_message() { }; _files() { print FILES }; words=(" +
        words + "); CURRENT=${#words}; _lpvctl'");
  };
  EXPECT_THAT(completed("lpvctl light m"), AllOf(HasSubstr("move:Move, turn or scale"), HasSubstr("add:")));
  EXPECT_THAT(completed("lpvctl light m"), Not(HasSubstr("render:")));
  EXPECT_THAT(completed("lpvctl light add room --r"), AllOf(HasSubstr("--radiance:"), HasSubstr("--server:")));
  EXPECT_THAT(completed("lpvctl session create --transport g"), AllOf(HasSubstr("gather\n"), HasSubstr("direct\n")));
  EXPECT_EQ(completed("lpvctl render x"), "FILES\n");
}

// Broken by: the same.
TEST(Pages, FishCompletes) {
  const TemporaryFolder folder;
  ASSERT_EQ(offline({"completion", "fish", "-o", folder.path("lpvctl.fish")}).exit, 0);
  const auto completed = [&](const std::string& line) {
    return bash("HOME=" + folder.path("") + " fish --no-config -c 'source " + folder.path("lpvctl.fish") +
                "; complete -C \"" + line + "\"'");
  };
  EXPECT_THAT(completed("lpvctl rend"), StartsWith("render\tRender one frame"));
  EXPECT_THAT(completed("lpvctl light m"), StartsWith("move\tMove, turn or scale"));
  EXPECT_THAT(completed("lpvctl light "), Not(HasSubstr("render")));
  EXPECT_THAT(completed("lpvctl light add room --ra"), StartsWith("--radiance\t"));
  EXPECT_THAT(completed("lpvctl session create --transport g"), StartsWith("gather"));
  EXPECT_THAT(completed("lpvctl completion z"), StartsWith("zsh"));
}

TEST(Pages, AreThereWhereTheProgramWasBuilt) {
  for (const char* file : {"man1/lpvctl.1", "man1/lpvctl-light.1", "lpvctl", "_lpvctl", "lpvctl.fish"}) {
    EXPECT_GT(std::filesystem::file_size(std::string(LPVCTL_PAGES) + "/" + file), 500U) << file;
  }
}

}  // namespace
}  // namespace lpv::cli
