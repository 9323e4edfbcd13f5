#include "rpc/support/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace lpv::rpc {
namespace {

constexpr std::chrono::milliseconds kPoll{10};

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

}  // namespace

std::string makeDirectory() {
  std::string pattern = (std::filesystem::temp_directory_path() / "lpv-child-XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("cannot make a folder " + pattern);
  return pattern;
}

std::string whereItIs(const std::string& built) {
  std::error_code none;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", none);
  const std::filesystem::path beside = self.parent_path() / std::filesystem::path(built).filename();
  return std::filesystem::exists(beside, none) ? beside.string() : built;
}

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
    wait();
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

}  // namespace lpv::rpc
