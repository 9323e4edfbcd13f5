#pragma once
// Completion of lpvctl's command line in bash, zsh and fish: commands, flags, the words that a value may be, files.

#include <string>

#include "pages/command_tree.h"

namespace lpv::cli {

std::string bashCompletion(const CommandInfo& root);
/// For a folder of $fpath as _lpvctl, or to be sourced.
std::string zshCompletion(const CommandInfo& root);
std::string fishCompletion(const CommandInfo& root);

}  // namespace lpv::cli
