# shellcheck shell=bash
# shellcheck disable=SC2034 # the constants are for the scripts that source this
# Sourced by the project's scripts: messages, timed steps with logs, clean-up. Needs bash 5 and coreutils only.
# Exit codes of every script that sources it: 0 done, 1 a step failed, 2 wrong usage, 3 packages are missing and
# cannot be installed from here, 128 + N ended by signal N.

export LC_ALL=C # numbers with a decimal point, messages that can be searched
readonly EXIT_USAGE=2 EXIT_NEEDS_ROOT=3

DRY_RUN=no             # yes: print what would be run, without running it
LOG_DIR=               # where steps put their output; set by start_logs
STEP_TABLE=()          # "name<TAB>time<TAB>result" of every step so far
FAILED_STEPS=()        # "name<TAB>log" of every step that failed
CLEANUPS=()            # functions to run on exit, the newest first
RESULT_OF=             # function that makes a step's result from its log; empty: "ok"
CHILD=                 # process group of the running step
PROGRESS_SECONDS=60    # how often a long step reports progress if stdout is not a terminal
# What compilers, GoogleTest, Node and Python's unittest write where something is wrong.
REASONS='error:|Error:|: Failure|^\[  FAILED|^not ok|^FAIL|AssertionError|not within|Timeout|Sanitizer:'

say() { printf '%s\n' "$*"; }
complain() { printf '%s: %s\n' "$0" "$*" >&2; }
die() { # die MESSAGE [EXIT_CODE]
  complain "$1"
  exit "${2:-1}"
}

is_dry() { [ "$DRY_RUN" = yes ]; }

# quoted WORD...: the words quoted for the shell.
quoted() {
  local word out=
  for word in "$@"; do
    if [[ $word =~ ^[A-Za-z0-9_./:=,@%+-]+$ ]]; then out+="$word "; else out+="'${word//\'/\'\\\'\'}' "; fi
  done
  printf '%s' "${out% }"
}

# --- clean-up ---------------------------------------------------------------------------------------------------------

at_exit() { CLEANUPS=("$1" "${CLEANUPS[@]}"); }

run_cleanups() {
  local code=$? action
  trap '' INT TERM HUP # a second Ctrl-C must not interrupt the clean-up
  trap - EXIT
  stop_child
  for action in "${CLEANUPS[@]}"; do "$action" || true; done
  exit "$code"
}

stop_child() {
  [ -n "$CHILD" ] || return 0
  kill -TERM -- "-$CHILD" 2>/dev/null || true
  wait "$CHILD" 2>/dev/null || true
  CHILD=
}

trap run_cleanups EXIT
trap 'exit 129' HUP
trap 'exit 130' INT
trap 'exit 143' TERM

# --- time -------------------------------------------------------------------------------------------------------------

now_ms() { printf '%s' $((${EPOCHREALTIME/./} / 1000)); }

# duration MILLISECONDS: 0.4 s, 12.0 s, 3:05 min
duration() {
  local ms=$1
  if [ "$ms" -lt 60000 ]; then
    printf '%d.%d s' $((ms / 1000)) $((ms % 1000 / 100))
  else
    printf '%d:%02d min' $((ms / 60000)) $((ms / 1000 % 60))
  fi
}

# --- steps ------------------------------------------------------------------------------------------------------------

# start_logs DIR: steps write DIR/NAME.log.
start_logs() {
  LOG_DIR=$1
  is_dry || mkdir -p "$LOG_DIR" || die "cannot make $LOG_DIR for the logs: run from a checkout that you may write to"
}

# step NAME COMMAND...: runs a command or function with its output in a log, times it, adds a line to the table, shows
# the log's tail when it fails. Returns the command's status, so that a caller can go on with what does not depend on it.
step() {
  local name=$1 began log status=0
  shift
  if is_dry; then
    dry_step "$name" "$@"
    return
  fi
  log=$(log_of "$name")
  began=$(now_ms)
  # A process group of its own, so that an interrupt takes down the whole step, with whatever it started.
  set -m
  : >"$log"
  "$@" >>"$log" 2>&1 </dev/null &
  CHILD=$!
  set +m
  watch_child "$name" "$log" "$began" || status=$?
  CHILD=
  finish_step "$name" $(($(now_ms) - began)) "$status" "$log"
  return "$status"
}

log_of() { printf '%s' "$LOG_DIR/${1//[^A-Za-z0-9.-]/-}.log"; }

# dry_step NAME COMMAND...: a function of ours says by itself what it would do.
dry_step() {
  local name=$1
  shift
  if declare -F "$1" >/dev/null; then
    say "$name:"
    "$@"
  else
    say "$name:"$'\n'"  $(quoted "$@")"
  fi
}

# watch_child NAME LOG BEGAN_MS: waits for CHILD; shows every second where it is, in a pipe now and then.
watch_child() {
  local name=$1 log=$2 began=$3 every=$PROGRESS_SECONDS spent told=0
  if [ -t 1 ]; then every=1; fi
  while kill -0 "$CHILD" 2>/dev/null; do
    sleep 0.1
    spent=$(($(now_ms) - began))
    if [ $((spent / 1000 - told)) -lt "$every" ]; then continue; fi
    told=$((spent / 1000))
    if [ -t 1 ]; then
      printf '\r\033[K%s' "$(progress "$name" "$spent" "$log" | cut -c "1-$((${COLUMNS:-80} - 1))")"
    else
      progress "$name" "$spent" "$log"
    fi
  done
  if [ -t 1 ]; then printf '\r\033[K'; fi
  wait "$CHILD"
}

progress() { printf '  ... %s, %s: %s\n' "$1" "$(duration "$2")" "$(tail -n 1 "$3" | tr -d '\r' | cut -c 1-80)"; }

# finish_step NAME MILLISECONDS STATUS LOG
finish_step() {
  local name=$1 took=$2 status=$3 log=$4 result=ok
  [ "$status" -eq 0 ] || result="failed ($status)"
  [ -z "$RESULT_OF" ] || result=$("$RESULT_OF" "$log")
  note_step "$name" "$took" "$result"
  [ "$status" -ne 0 ] || return 0
  FAILED_STEPS+=("$name"$'\t'"$log")
  complain "$name failed with status $status; the end of its log:"
  tail -n 30 "$log" | sed 's/^/    /' >&2
  complain "the whole log: $log"
}

# say_why: of every step that failed, the lines of its log that look like a reason: what many steps later are far above.
say_why() {
  local row name log
  for row in "${FAILED_STEPS[@]}"; do
    IFS=$'\t' read -r name log <<<"$row"
    printf '\n%s failed:\n' "$name"
    grep -E "$REASONS" "$log" | cut -c 1-200 | head -n 20 | sed 's/^/    /' || true
    printf '    the whole log: %s\n' "$log"
  done
}

# note_step NAME MILLISECONDS RESULT: a line on the way and in the final table.
note_step() {
  STEP_TABLE+=("$1"$'\t'"$(duration "$2")"$'\t'"$3")
  printf '%-34s %10s   %s\n' "$1" "$(duration "$2")" "$3"
}

# print_table BEGAN_MS: every step, what it took, how it ended.
print_table() {
  local row name took result
  printf '\n%-34s %10s   %s\n' step took result
  for row in "${STEP_TABLE[@]}"; do
    IFS=$'\t' read -r name took result <<<"$row"
    printf '%-34s %10s   %s\n' "$name" "$took" "$result"
  done
  note_total "$1"
}

# source_date ROOT: seconds since 1970 of the checkout's commit; where it has no history, of its CMakeLists.txt.
source_date() {
  git -C "$1" log -1 --format=%ct 2>/dev/null || stat -c %Y "$1"/CMakeLists.txt
}

note_total() { printf '%-34s %10s\n' total "$(duration $(($(now_ms) - $1)))"; }

# --- machine ----------------------------------------------------------------------------------------------------------

# A gRPC translation unit at its worst, in MB: measured with g++ 12.
readonly MB_PER_JOB=700 MB_PER_SANITIZER_JOB=1300

# memory_mb: what a build may use: free memory, or what the container's limit leaves of it.
memory_mb() {
  local available limit used
  available=$(awk '/^MemAvailable:/ { print int($2 / 1024) }' /proc/meminfo 2>/dev/null || true)
  : "${available:=1024}" # no /proc: a careful guess
  limit=$(cat /sys/fs/cgroup/memory.max 2>/dev/null || true)
  used=$(cat /sys/fs/cgroup/memory.current 2>/dev/null || true)
  if [[ $limit =~ ^[0-9]+$ && $used =~ ^[0-9]+$ && $(((limit - used) / 1048576)) -lt $available ]]; then
    available=$(((limit - used) / 1048576))
  fi
  printf '%s' "$available"
}

# jobs_for MB: parallel jobs that cores and memory allow, at least one.
jobs_for() {
  local cores memory jobs
  cores=$(nproc)
  memory=$(memory_mb)
  jobs=$((memory / $1))
  [ "$jobs" -le "$cores" ] || jobs=$cores
  [ "$jobs" -ge 1 ] || jobs=1
  printf '%s' "$jobs"
}

# need_count OPTION VALUE: VALUE must be a positive whole number.
need_count() { [[ $2 =~ ^[1-9][0-9]*$ ]] || die "$1 takes a positive whole number, not '$2'" "$EXIT_USAGE"; }

# need_value OPTION ARGUMENT_COUNT: the option must be followed by something.
need_value() { [ "$2" -ge 2 ] || die "$1 needs a value; see --help" "$EXIT_USAGE"; }
