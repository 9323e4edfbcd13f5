#pragma once
// lpvctl run to its end against a real server.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "rpc/cli/cli_files.h"
#include "rpc/support/server_process.h"

namespace lpv::cli {

struct Outcome {
  int exit = -1;  ///< minus the signal where one ended it
  std::string out;
  std::string err;
};

inline Outcome runLpvctl(std::vector<std::string> arguments) {
  // Who lpvctl is in which session is kept with the test, not with the user who runs it.
  static const TemporaryFolder kState;
  setenv("XDG_STATE_HOME", kState.path("state").c_str(), 1);
  // Assimp and the image libraries leak on broken files; leaks of ours are looked for where the library is linked.
  if (rpc::kSanitized) setenv("LSAN_OPTIONS", "detect_leaks=0", 0);
  rpc::ChildProcess child(LPVCTL_PATH, arguments);
  const std::optional<int> status = child.wait(std::chrono::seconds(120));
  return {status.value_or(-1000), child.output(), child.errors()};
}

/// Against the test binary's own server; checks that errors are one line and only where there is one.
inline Outcome lpvctl(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"--server", rpc::server().address()});
  Outcome run = runLpvctl(arguments);
  const auto lines = std::count(run.err.begin(), run.err.end(), '\n');
  EXPECT_TRUE(run.exit == 0 || lines == 1) << run.err;
  return run;
}

/// As lpvctl, expected to succeed; returns stdout without the last line end.
inline std::string lpvctlOut(const std::vector<std::string>& arguments) {
  Outcome run = lpvctl(arguments);
  EXPECT_EQ(run.exit, 0) << testing::PrintToString(arguments) << ": " << run.err;
  if (!run.out.empty() && run.out.back() == '\n') run.out.pop_back();
  return run.out;
}

}  // namespace lpv::cli
