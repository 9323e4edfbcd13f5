# shellcheck shell=bash
# Sourced after steps.sh: installs the missing packages of deploy/packages. Uses apt only when something is
# missing, so a second run works without a network.

PACKAGE_LIST=$(dirname "${BASH_SOURCE[0]}")/../packages
readonly LOCK_SECONDS=600 # how long to wait for another package manager
readonly POLICY=/usr/sbin/policy-rc.d SAVED_POLICY=/usr/sbin/policy-rc.d.saved-by-lpv
readonly POLICY_MARK="lpv: services stay off while packages are installed"
OUR_POLICY=no # yes while ours is in place

# listed_packages GROUP...: the names of the packages in these groups.
listed_packages() {
  local groups=" $* "
  awk -v groups="$groups" '!/^#/ && NF >= 2 && index(groups, " " $1 " ") { print $2 }' "$PACKAGE_LIST"
}

# page_group: "page", or nothing where node 18 or newer and npm are there from elsewhere.
page_group() {
  local major
  major=$(node --version 2>/dev/null | sed -n 's/^v\([0-9]*\).*/\1/p')
  if command -v npm >/dev/null && [ "${major:-0}" -ge 18 ]; then return; fi
  echo page
}

# missing_packages GROUP...: the packages of these groups that are not installed.
missing_packages() {
  local installed name
  installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' 2>/dev/null || true)
  while read -r name; do
    [[ $'\n'$installed$'\n' == *$'\n'"$name installed"$'\n'* ]] || printf '%s\n' "$name"
  done < <(listed_packages "$@")
}

# ensure_packages GROUP...: installs all packages of the groups, or ends the script.
ensure_packages() {
  local missing
  if ! command -v dpkg-query apt-get >/dev/null; then
    die "there is no apt-get here; install these packages by other means: $(listed_packages "$@" | tr '\n' ' ')" "$EXIT_NEEDS_ROOT"
  fi
  mapfile -t missing < <(missing_packages "$@")
  if [ "${#missing[@]}" -eq 0 ]; then
    note_step "packages" 0 "all present"
    return
  fi
  if is_dry; then
    say "packages:"$'\n'"  $(apt_line "${missing[@]}")"
    return
  fi
  warn_if_not_debian_12
  become_root_or_explain "${missing[@]}"
  hold_services
  step "packages" apt_install "${missing[@]}" || exit 1
  release_services
}

warn_if_not_debian_12() {
  local name
  name=$(. /etc/os-release 2>/dev/null && printf '%s %s' "${ID:-unknown}" "${VERSION_ID:-}")
  [ "$name" = "debian 12" ] || complain "written for Debian 12, this is ${name:-unknown}: packages may have other names"
}

# apt_line PACKAGE...: the command that installs the packages.
apt_line() { printf 'apt-get update && apt-get install -y --no-install-recommends %s' "$*"; }

as_root() { if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo -n "$@"; fi; }

# become_root_or_explain PACKAGE...: sudo may ask for a password only when a person sits at the terminal.
become_root_or_explain() {
  [ "$(id -u)" -ne 0 ] || return 0
  if command -v sudo >/dev/null; then
    if sudo -n true 2>/dev/null; then return 0; fi
    if [ -t 0 ] && sudo -v; then return 0; fi
  fi
  complain "packages are missing and this user may not install them; as root, run:"
  say "$(apt_line "$@")" >&2
  exit "$EXIT_NEEDS_ROOT"
}

# --- apt, quiet and patient ---------------------------------------------------------------------------------------------

apt_install() {
  retry_while_locked update || echo "apt-get update failed: trying with the lists that are there"
  retry_while_locked install -y --no-install-recommends "$@"
}

# retry_while_locked APT_ARGUMENT...: DPkg::Lock::Timeout covers dpkg's lock only; those of the lists and of the archive
# make apt-get fail at once.
retry_while_locked() {
  local deadline=$((SECONDS + LOCK_SECONDS)) output
  while true; do
    if output=$(apt_get "$@" 2>&1 | tee -a /dev/stderr); then return 0; fi
    if ! grep -Eq 'Could not get lock|Unable to lock' <<<"$output" || [ "$SECONDS" -ge "$deadline" ]; then return 1; fi
    echo "waiting for another package manager to release its lock"
    sleep 3
  done
}

apt_get() {
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o "DPkg::Lock::Timeout=$LOCK_SECONDS" -o Acquire::Retries=3 "$@"
}

# --- no service starts because it was installed -------------------------------------------------------------------------

hold_services() {
  at_exit release_services
  # A run that was killed may have left ours; then what it saved, if anything, is the machine's own.
  if [ -e "$POLICY" ] && ! grep -q "$POLICY_MARK" "$POLICY"; then as_root mv "$POLICY" "$SAVED_POLICY"; fi
  OUR_POLICY=yes
  printf '#!/bin/sh\n# %s\nexit 101\n' "$POLICY_MARK" | as_root tee "$POLICY" >/dev/null
  as_root chmod 755 "$POLICY"
}

release_services() {
  [ "$OUR_POLICY" = yes ] || return 0
  OUR_POLICY=no
  if [ -e "$SAVED_POLICY" ]; then as_root mv "$SAVED_POLICY" "$POLICY"; else as_root rm -f "$POLICY"; fi
}
