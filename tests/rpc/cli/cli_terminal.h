#pragma once
// lpvctl on a terminal of its own: what it draws there, what it asks, what it is answered.

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rpc/cli/cli_run.h"

namespace lpv::cli {

/// lpvctl against the test binary's own server, with stdin, stdout and stderr on one terminal.
class OnTerminal {
 public:
  explicit OnTerminal(std::vector<std::string> arguments) {
    std::vector<std::string> words{LPVCTL_PATH, "--server", rpc::server().address()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    child_ = forkpty(&terminal_, nullptr, nullptr, nullptr);
    EXPECT_GE(child_, 0) << "there are no terminals here: /dev/ptmx, and devpts at /dev/pts, are needed";
    if (child_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      execv(argv[0], argv.data());
      _exit(127);
    }
  }
  ~OnTerminal() {
    if (child_ > 0 && !exit_) {
      kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
    close(terminal_);
  }
  OnTerminal(const OnTerminal&) = delete;
  OnTerminal& operator=(const OnTerminal&) = delete;

  /// Reads until the terminal shows this; false where the process ends, or a minute goes by, without it.
  bool shows(const std::string& text) {
    return readUntil([&] { return seen_.find(text) != std::string::npos; });
  }
  void type(const std::string& text) const {
    EXPECT_EQ(write(terminal_, text.data(), text.size()), ssize_t(text.size()));
  }
  /// Waits for the end: the exit code, minus the signal where one ended it.
  int finish() {
    (void)readUntil([] { return false; });
    int status = 0;
    if (child_ > 0 && !exit_ && waitpid(child_, &status, 0) == child_) {
      exit_ = WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
    }
    return exit_.value_or(-1000);
  }
  const std::string& seen() const { return seen_; }

 private:
  template <typename Condition>
  bool readUntil(Condition done) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (child_ > 0 && !done() && std::chrono::steady_clock::now() < end) {
      pollfd from{terminal_, POLLIN, 0};
      if (poll(&from, 1, 100) <= 0) continue;
      char bytes[4096];
      const ssize_t count = read(terminal_, bytes, sizeof bytes);
      if (count <= 0) return done();  // the other side is closed
      seen_.append(bytes, std::size_t(count));
    }
    return done();
  }

  pid_t child_ = -1;
  int terminal_ = -1;
  std::string seen_;
  std::optional<int> exit_;
};

}  // namespace lpv::cli
