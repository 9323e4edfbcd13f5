# shellcheck shell=bash
# Sourced after steps.sh by build and test: buildah in a folder of its own, and what an image's files are.

# in_storage buildah COMMAND...: STORAGE is the folder. vfs and chroot need no kernel module and no cgroup.
in_storage() {
  shift
  if is_dry; then
    say "  buildah $(quoted "$@")"
  else
    BUILDAH_ISOLATION=chroot buildah --storage-driver vfs --root "$STORAGE/root" --runroot "$STORAGE/run" "$@"
  fi
}

# digests_of FOLDER: a line per file, link and folder below it: mode, owner, digest or target, path. What the engine puts
# there for a run (names of hosts) and mounts is left out.
digests_of() {
  (
    cd "$1" || exit
    files_here \( -type d -o -type f \) -printf '%m %U:%G %y %p\n' -o -type l -printf '%U:%G %y %p -> %l\n'
    files_here -type f -print0 | xargs -0 sha256sum
  ) | LC_ALL=C sort
}

files_here() { find . -xdev \( -path ./proc -o -path ./sys -o -path ./dev -o -path ./run \) -prune -o "$@"; }
