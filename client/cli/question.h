#pragma once
// Questions to whoever sits at the terminal.

#include <string>

namespace lpv::cli {

/// True if somebody can be asked: stdin and stderr are a terminal.
bool canAsk();

/// Prints the question on stderr and returns the first line of the answer; empty at the end of stdin and after Ctrl-C.
std::string ask(const std::string& question);

}  // namespace lpv::cli
