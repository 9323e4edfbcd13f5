// Part of every test binary that starts servers.

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

constexpr std::size_t kLogTail = 4000;  // bytes of a server's log worth showing after a failure

/// Shows what the servers said during a test that failed.
class LogOnFailure final : public testing::EmptyTestEventListener {
  void OnTestEnd(const testing::TestInfo& info) override {
    if (!info.result()->Failed()) return;
    for (const ServerProcess* process : ServerProcess::live()) {
      const std::string log = process->log();
      std::cout << "--- lpvd on port " << process->port() << " said last:\n"
                << log.substr(log.size() - std::min(log.size(), kLogTail)) << "---\n";
    }
  }
};

[[maybe_unused]] const bool kListening = [] {
  testing::UnitTest::GetInstance()->listeners().Append(new LogOnFailure);
  return true;
}();

}  // namespace
}  // namespace lpv::rpc
