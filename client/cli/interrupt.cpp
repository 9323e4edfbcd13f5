#include "interrupt.h"

#include <pthread.h>
#include <signal.h>

#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

namespace lpv::cli {
namespace {

std::atomic<bool> wasInterrupted{false};
std::mutex clientsMutex;
std::vector<client::Client> clients;

sigset_t interruptSignals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

/// Runs on its own thread instead of in a signal handler, so that it may lock mutexes and cancel calls.
void waitForInterrupt() {
  const sigset_t set = interruptSignals();
  int number = 0;
  if (sigwait(&set, &number) != 0) return;
  wasInterrupted = true;
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);  // a second signal is delivered here and ends the process
  const std::lock_guard lock(clientsMutex);
  for (client::Client& c : clients) c.cancel();
}

}  // namespace

void watchInterrupts() {
  const sigset_t set = interruptSignals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  std::thread([] {
    waitForInterrupt();
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
  }).detach();
}

void cancelOnInterrupt(const client::Client& client) {
  const std::lock_guard lock(clientsMutex);
  clients.push_back(client);
  if (wasInterrupted) clients.back().cancel();
}

bool interrupted() { return wasInterrupted; }

}  // namespace lpv::cli
