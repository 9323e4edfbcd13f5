#include "progress.h"

#include <unistd.h>

#include <iostream>
#include <utility>

#include "output.h"

namespace lpv::cli {
namespace {

constexpr int kWidth = 30;
constexpr auto kInterval = std::chrono::milliseconds(100);

}  // namespace

bool onTerminal() { return isatty(STDERR_FILENO) != 0; }

void statusLine(const std::string& text) { std::cerr << "\r" << visible(text) << "\033[K" << std::flush; }

ProgressBar::ProgressBar(std::string title) : title_(std::move(title)), terminal_(onTerminal()) {}

ProgressBar::~ProgressBar() {
  if (drawn_) statusLine("");
}

void ProgressBar::show(std::uint64_t done, std::uint64_t total) {
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ || (drawn_ && now - last_ < kInterval && done != total)) return;
  last_ = now;
  drawn_ = true;
  if (total == 0) return statusLine(title_ + " " + std::to_string(done / 1000000) + " MB");
  const double share = double(done) / double(total);
  const int filled = int(share * kWidth);
  statusLine(title_ + " [" + std::string(std::size_t(filled), '#') + std::string(std::size_t(kWidth - filled), ' ') +
             "] " + std::to_string(int(share * 100.0)) + " %");
}

Spinner::Spinner(std::string title) {
  if (onTerminal()) thread_ = std::thread([this, title = std::move(title)] { draw(title); });
}

Spinner::~Spinner() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Spinner::draw(const std::string& title) {
  std::unique_lock lock(mutex_);
  int seconds = 0;
  while (!changed_.wait_for(lock, std::chrono::seconds(1), [this] { return ended_; })) {
    statusLine(title + ", " + std::to_string(++seconds) + " s");
  }
  if (seconds > 0) statusLine("");
}

}  // namespace lpv::cli
