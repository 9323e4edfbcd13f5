#pragma once
// Manual pages in roff, section 1: lpvctl(1), and lpvctl-light(1) for each command below it.

#include <string>
#include <utility>
#include <vector>

#include "pages/command_tree.h"

namespace lpv::cli {

/// The page of `lpvctl` or of one of its commands, those below it included.
std::string manPage(const CommandInfo& root, const CommandInfo& of);

/// File name and page of lpvctl and each of its commands.
std::vector<std::pair<std::string, std::string>> manPages(const CommandInfo& root);

}  // namespace lpv::cli
