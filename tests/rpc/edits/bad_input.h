#pragma once
// The table of bad input: what is sent, and how it has to be refused.

#include <functional>
#include <string>
#include <vector>

#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {

/// One session for all rows.
struct World {
  Stubs stubs{server().address()};
  std::string session = makeLitSession(stubs);
};

struct Row {
  std::string name;
  std::function<grpc::Status(World&)> send;
  StatusCode code;
  std::string field;
  std::string text;  ///< the limit, or what is wrong
};

/// Every row.
std::vector<Row> badInput();

}  // namespace lpv::rpc
