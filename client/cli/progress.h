#pragma once
// Progress bar on stderr if that is a terminal; nothing otherwise.

#include <chrono>
#include <cstdint>
#include <string>

namespace lpv::cli {

class ProgressBar {
 public:
  explicit ProgressBar(std::string title);
  /// Erases the bar.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Redraws the bar, at most ten times a second. `total` 0: the end is not known.
  void show(std::uint64_t done, std::uint64_t total);

 private:
  std::string title_;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point last_;
};

/// True if stderr is a terminal.
bool onTerminal();

/// Writes a line on stderr that the next one overwrites; "" erases it.
void statusLine(const std::string& text);

}  // namespace lpv::cli
