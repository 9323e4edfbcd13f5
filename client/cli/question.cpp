#include "question.h"

#include <poll.h>
#include <unistd.h>

#include <iostream>

#include "interrupt.h"
#include "output.h"

namespace lpv::cli {

bool canAsk() { return isatty(STDIN_FILENO) != 0 && isatty(STDERR_FILENO) != 0; }

std::string ask(const std::string& question) {
  std::cerr << "lpvctl: " << visible(question) << " " << std::flush;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (!interrupted() && poll(&input, 1, 100) == 0) {
  }
  std::string answer;
  if (!interrupted()) std::getline(std::cin, answer);
  return answer;
}

}  // namespace lpv::cli
