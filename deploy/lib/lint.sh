# shellcheck shell=bash
# Sourced after steps.sh by scripts that run in the root of the checkout: what the linters look at.

# our_sources PATTERN...: C++ files that are not generated, NUL-separated.
our_sources() {
  local names=() pattern
  for pattern in "$@"; do names+=(-o -name "$pattern"); done
  find server client proto tests -type f \( "${names[@]:1}" \) -print0
}

have_clang_format() { command -v clang-format-16 >/dev/null; }

format_check() {
  if is_dry; then
    say "  clang-format-16 --dry-run --Werror on every .cpp and .h"
  else
    our_sources '*.cpp' '*.h' | xargs -0 clang-format-16 --dry-run --Werror
  fi
}

# tidy_check BUILD_FOLDER JOBS: static analysis of every file that the build compiled.
tidy_check() {
  if is_dry; then
    say "  clang-tidy-16 -p $1 on every .cpp, $2 at a time"
  else
    our_sources '*.cpp' | xargs -0 -n 1 -P "$2" clang-tidy-16 -p "$1" --quiet --warnings-as-errors='*'
  fi
}
