#pragma once
// A server with its door for browsers, and its metrics.

#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "rpc/streams/watched.h"
#include "rpc/support/rpc.h"
#include "rpc/support/web_client.h"

namespace lpv::rpc {

class Browsers {
 public:
  explicit Browsers(std::vector<std::string> arguments = {})
      : watched_((arguments.insert(arguments.end(), {"--web", ":0", "--web-port-file", directory_ + "/web"}),
                  std::move(arguments))) {
    std::ifstream(directory_ + "/web") >> port_;  // written before the server serves
  }
  ~Browsers() {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }
  Browsers(const Browsers&) = delete;
  Browsers& operator=(const Browsers&) = delete;

  ServerProcess& server() { return watched_.server(); }
  Watched& watched() { return watched_; }
  int port() const { return port_; }
  double refused(const std::string& why) const { return watched_.metric("lpv_web_refused_total{why=\"" + why + "\"}"); }

 private:
  const std::string directory_ = makeDirectory();
  Watched watched_;
  int port_ = 0;
};

/// The process's own, with default options.
inline Browsers& browsers() {
  static Browsers browsers({"--max-edits-per-second", "100000"});
  return browsers;
}

}  // namespace lpv::rpc
