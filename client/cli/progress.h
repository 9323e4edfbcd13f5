#pragma once
// Progress of something long: a bar on a terminal's stderr, nothing in a pipe.

#include <chrono>
#include <cstdint>
#include <string>

namespace lpv::cli {

class ProgressBar {
 public:
  explicit ProgressBar(std::string title);
  /// Takes the bar away.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Redraws at most ten times a second. `total` 0: no known end.
  void show(std::uint64_t done, std::uint64_t total);

 private:
  std::string title_;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point last_;
};

/// Whether stderr is a terminal.
bool onTerminal();

/// A line on the terminal's stderr that the next one overwrites; "" takes it away.
void statusLine(const std::string& text);

}  // namespace lpv::cli
