#include "app/signals.h"

namespace lpv::app {

Signals::Signals() {
  sigemptyset(&ends_);
  sigaddset(&ends_, SIGINT);
  sigaddset(&ends_, SIGTERM);
  all_ = ends_;
  sigaddset(&all_, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &all_, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int Signals::waitForEnd(const std::function<void()>& reload) {
  while (true) {
    int signal = 0;
    sigwait(&all_, &signal);
    if (signal == SIGHUP) {
      reload();
      continue;
    }
    pthread_sigmask(SIG_UNBLOCK, &ends_, nullptr);  // for this thread: the next one does what it does by default
    return signal;
  }
}

}  // namespace lpv::app
