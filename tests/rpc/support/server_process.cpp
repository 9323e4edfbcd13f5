#include "rpc/support/server_process.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace lpv::rpc {
namespace {

constexpr std::chrono::milliseconds kPoll{10};

std::vector<const ServerProcess*>& liveServers() {
  static std::vector<const ServerProcess*> servers;
  return servers;
}

}  // namespace

const std::vector<const ServerProcess*>& ServerProcess::live() { return liveServers(); }

ServerProcess::ServerProcess(const std::vector<std::string>& arguments, const std::string& listen,
                             const std::string& program) {
  // Freed memory that a sanitizer keeps aside would read as a leak of the server.
  if (kSanitized) setenv("ASAN_OPTIONS", "quarantine_size_mb=1:malloc_context_size=8", 0);
  portFile_ = makeDirectory() + "/port";
  std::vector<std::string> words{"--listen", listen, "--port-file", portFile_};
  words.insert(words.end(), arguments.begin(), arguments.end());
  process_ = std::make_unique<ChildProcess>(program.empty() ? whereItIs(LPVD_PATH) : program, words);
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!(std::ifstream(portFile_) >> port_)) {
    if (!running() || std::chrono::steady_clock::now() > until) {
      throw std::runtime_error("lpvd did not start:\n" + log());
    }
    std::this_thread::sleep_for(kPoll);
  }
  liveServers().push_back(this);
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
  static ServerProcess process({"--max-edits-per-second", "100000"});
  return process;
}

Finished runServer(const std::vector<std::string>& arguments, std::chrono::milliseconds patience) {
  ChildProcess process(whereItIs(LPVD_PATH), arguments);
  Finished out;
  out.status = process.wait(patience);
  out.output = process.output();
  out.errors = process.errors();
  return out;
}

}  // namespace lpv::rpc
