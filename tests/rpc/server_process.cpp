#include "rpc/server_process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace lpv::rpc {
namespace {

constexpr std::chrono::seconds kStartPatience{60};
constexpr std::chrono::milliseconds kPoll{10};
constexpr std::size_t kLogTail = 4000;  // bytes of a server's log worth showing after a failure

std::string makeDirectory() {
  std::string pattern = (std::filesystem::temp_directory_path() / "lpv-rpc-XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("cannot make a folder " + pattern);
  return pattern;
}

std::string contents(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream out;
  out << file.rdbuf();
  return out.str();
}

/// Between fork and exec: only what is allowed in a copy of a process with threads.
[[noreturn]] void become(const char* out, const char* err, char* const* argv, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(126);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  dup2(open(out, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600), STDOUT_FILENO);
  dup2(open(err, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600), STDERR_FILENO);
  execv(argv[0], argv);
  _exit(127);
}

std::vector<const ServerProcess*>& liveServers() {
  static std::vector<const ServerProcess*> servers;
  return servers;
}

/// Shows what the servers said during a test that failed.
class LogOnFailure final : public testing::EmptyTestEventListener {
  void OnTestEnd(const testing::TestInfo& info) override {
    if (!info.result()->Failed()) return;
    for (const ServerProcess* process : liveServers()) {
      const std::string log = process->log();
      std::cout << "--- lpvd on port " << process->port() << " said last:\n"
                << log.substr(log.size() - std::min(log.size(), kLogTail)) << "---\n";
    }
  }
};

void showLogsOnFailure() {
  static const bool kOnce = [] {
    testing::UnitTest::GetInstance()->listeners().Append(new LogOnFailure);
    return true;
  }();
  (void)kOnce;
}

}  // namespace

ChildProcess::ChildProcess(const std::string& program, const std::vector<std::string>& arguments)
    : directory_(makeDirectory()) {
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string out = directory_ + "/out";
  const std::string err = directory_ + "/err";
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) become(out.c_str(), err.c_str(), argv.data(), parent);
  if (pid_ < 0) throw std::runtime_error("cannot fork");
}

ChildProcess::~ChildProcess() {
  if (!wait(std::chrono::milliseconds(0))) {
    signal(SIGKILL);
    wait(std::chrono::seconds(30));
  }
  std::error_code ignored;
  std::filesystem::remove_all(directory_, ignored);
}

void ChildProcess::signal(int number) const { ::kill(pid_, number); }

std::optional<int> ChildProcess::wait(std::chrono::milliseconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (!ended_) {
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) == pid_) {
      ended_ = WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
    } else if (std::chrono::steady_clock::now() >= until) {
      break;
    } else {
      std::this_thread::sleep_for(kPoll);
    }
  }
  return ended_;
}

std::string ChildProcess::output() const { return contents(directory_ + "/out"); }
std::string ChildProcess::errors() const { return contents(directory_ + "/err"); }

ServerProcess::ServerProcess(const std::vector<std::string>& arguments, const std::string& listen) {
  // Freed memory that a sanitizer keeps aside would read as a leak of the server.
  if (kSanitized) setenv("ASAN_OPTIONS", "quarantine_size_mb=1:malloc_context_size=8", 0);
  portFile_ = makeDirectory() + "/port";
  std::vector<std::string> words{"--listen", listen, "--port-file", portFile_};
  words.insert(words.end(), arguments.begin(), arguments.end());
  process_ = std::make_unique<ChildProcess>(LPVD_PATH, words);
  const auto until = std::chrono::steady_clock::now() + kStartPatience;
  while (!(std::ifstream(portFile_) >> port_)) {
    if (!running() || std::chrono::steady_clock::now() > until) {
      throw std::runtime_error("lpvd did not start:\n" + log());
    }
    std::this_thread::sleep_for(kPoll);
  }
  liveServers().push_back(this);
  showLogsOnFailure();
}

ServerProcess::~ServerProcess() {
  std::erase(liveServers(), this);
  std::error_code ignored;
  std::filesystem::remove_all(std::filesystem::path(portFile_).parent_path(), ignored);
}

std::int64_t ServerProcess::statusBytes(const std::string& key) const {
  std::ifstream file("/proc/" + std::to_string(process_->pid()) + "/status");
  std::string word;
  std::int64_t kilobytes = -1;
  while (file >> word) {
    if (word == key) {
      file >> kilobytes;
      break;
    }
  }
  return kilobytes * 1024;
}

std::int64_t ServerProcess::residentBytes() const { return statusBytes("VmRSS:"); }
std::int64_t ServerProcess::peakBytes() const { return statusBytes("VmHWM:"); }

void ServerProcess::forgetPeak() const {
  std::ofstream("/proc/" + std::to_string(process_->pid()) + "/clear_refs") << "5";  // see proc(5)
}

ServerProcess& server() {
  static ServerProcess process;
  return process;
}

Finished runServer(const std::vector<std::string>& arguments, std::chrono::milliseconds patience) {
  ChildProcess process(LPVD_PATH, arguments);
  Finished out;
  out.status = process.wait(patience);
  out.output = process.output();
  out.errors = process.errors();
  return out;
}

}  // namespace lpv::rpc
