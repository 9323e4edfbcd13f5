#pragma once
// Progress on stderr if that is a terminal; nothing otherwise.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

namespace lpv::cli {

class ProgressBar {
 public:
  explicit ProgressBar(std::string title);
  /// Erases the bar.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Redraws the bar, at most ten times a second. `total` 0: the end is not known, so that megabytes are shown.
  void show(std::uint64_t done, std::uint64_t total);

 private:
  std::string title_;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point last_;
};

/// Shows how long a call has taken that says nothing of its progress: "rendering, 12 s", from the first second on.
class Spinner {
 public:
  explicit Spinner(std::string title);
  /// Erases the line.
  ~Spinner();
  Spinner(const Spinner&) = delete;
  Spinner& operator=(const Spinner&) = delete;

 private:
  void draw(const std::string& title);

  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;
  std::thread thread_;
};

/// True if stderr is a terminal.
bool onTerminal();

/// Writes a line on stderr that the next one overwrites; "" erases it.
void statusLine(const std::string& text);

}  // namespace lpv::cli
