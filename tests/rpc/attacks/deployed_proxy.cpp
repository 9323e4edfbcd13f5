#include "rpc/attacks/deployed_proxy.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <vector>

namespace lpv::rpc {
namespace {

std::string contents(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream out;
  out << file.rdbuf();
  return out.str();
}

bool listens(int port) {
  const int probe = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(std::uint16_t(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const bool open = connect(probe, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  close(probe);
  return open;
}

/// For env(1): the variables, then the program.
std::vector<std::string> commandLine(const Authority& authority, int port, int backendPort, int opsPort,
                                     const std::map<std::string, std::string>& more) {
  const CertificateFiles own = authority.issue("proxy");
  std::map<std::string, std::string> variables = {
      {"LPV_PROXY_BIND", "127.0.0.1:" + std::to_string(port)},
      {"LPV_PROXY_CERT", authority.write("proxy-chain-and-key.pem", contents(own.certificate) + contents(own.key))},
      {"LPV_BACKEND", "127.0.0.1:" + std::to_string(backendPort)},
      {"LPV_BACKEND_NAME", "localhost"},
      {"LPV_BACKEND_CA", authority.file()},
      {"LPV_BACKEND_WEB", "127.0.0.1:" + std::to_string(freePort())},
      {"LPV_OPS_PORT", std::to_string(opsPort)}};
  for (const auto& [name, value] : more) variables[name] = value;
  std::vector<std::string> out;
  for (const auto& [name, value] : variables) out.push_back(name + "=" + value);
  out.insert(out.end(), {HAPROXY_PATH, "-f", PROXY_CONFIGURATION});
  return out;
}

}  // namespace

int freePort() {
  const int probe = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  socklen_t size = sizeof address;
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (bind(probe, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
      getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    throw std::runtime_error("there is no free port");
  }
  close(probe);
  return ntohs(address.sin_port);
}

DeployedProxy::DeployedProxy(const Authority& authority, int backendPort, int opsPort,
                             const std::map<std::string, std::string>& more)
    : port_(freePort()) {
  std::vector<std::string> words = commandLine(authority, port_, backendPort, opsPort, more);
  words.push_back("-db");
  process_ = std::make_unique<ChildProcess>("/usr/bin/env", words);
  for (int i = 0; i < 1000 && running() && !listens(port_); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  if (!running()) throw std::runtime_error("haproxy does not run: " + errors());
}

DeployedProxy::~DeployedProxy() = default;

std::int64_t DeployedProxy::residentBytes() const {
  std::ifstream file("/proc/" + std::to_string(process_->pid()) + "/statm");
  std::int64_t all = 0, resident = 0;
  file >> all >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

int DeployedProxy::check(const Authority& authority, std::string* said) {
  std::vector<std::string> words = commandLine(authority, freePort(), freePort(), freePort(), {});
  words.push_back("-c");
  ChildProcess process("/usr/bin/env", words);
  const std::optional<int> status = process.wait();
  *said = process.output() + process.errors();
  return status.value_or(-1);
}

}  // namespace lpv::rpc
