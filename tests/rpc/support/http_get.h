#pragma once

#include <string>

namespace lpv::rpc {

struct HttpAnswer {
  int status = 0;  ///< 0: nobody answered
  std::string type;  ///< Content-Type
  std::string body;
};

/// GET of a path from 127.0.0.1, by hand.
HttpAnswer httpGet(int port, const std::string& path);

}  // namespace lpv::rpc
