#pragma once
// A server with its monitoring endpoint.

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "rpc/support/http_get.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {

inline std::vector<std::string> linesOf(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

/// A server with its endpoint on a free port.
class Watched {
 public:
  explicit Watched(std::vector<std::string> arguments = {}) {
    arguments.insert(arguments.end(), {"--ops-listen", ":0", "--ops-port-file", directory_ + "/ops"});
    server_ = std::make_unique<ServerProcess>(arguments);
    std::ifstream(directory_ + "/ops") >> port_;  // written before the server serves
  }
  ~Watched() {
    server_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }
  Watched(const Watched&) = delete;
  Watched& operator=(const Watched&) = delete;

  ServerProcess& server() { return *server_; }
  int port() const { return port_; }
  HttpAnswer get(const std::string& path) const { return httpGet(port_, path); }
  /// Every series of a scrape, by its name with labels.
  std::map<std::string, double> scrape() const {
    std::map<std::string, double> out;
    for (const std::string& line : linesOf(get("/metrics").body)) {
      const std::size_t space = line.rfind(' ');
      if (!line.starts_with("#")) out[line.substr(0, space)] = std::stod(line.substr(space + 1));
    }
    return out;
  }
  double metric(const std::string& series) const {
    const auto all = scrape();
    const auto found = all.find(series);
    return found == all.end() ? -1.0 : found->second;
  }

 private:
  const std::string directory_ = makeDirectory();
  std::unique_ptr<ServerProcess> server_;
  int port_ = 0;
};

}  // namespace lpv::rpc
