# Sourced by run-tests, run-demo and .ci/run.  Leaves the working directory at the root of the repository.
# shellcheck shell=bash

cd "$(dirname "${BASH_SOURCE[0]}")/.."

say() { printf '\n== %s\n' "$*"; }
die() { printf '%s\n' "$*" >&2; exit 1; }

# packages SECTION: the names under [SECTION] in .ci/packages.txt.
packages() {
  awk -v section="[$1]" '/^\[/ { on = $0 == section; next } on && NF && !/^#/ { print $1 }' .ci/packages.txt
}

# need SECTION: installs what is missing of it.  Asks nobody where nothing is missing.
need() {
  local missing=() package
  for package in $(packages "$1"); do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  say "Installing ${missing[*]}"
  command -v apt-get >/dev/null || die "Not a Debian system: please install ${missing[*]}"
  local root=()
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || die "Please install, as root: apt-get install ${missing[*]}"
    root=(sudo)
  fi
  # A list that is a day old still installs; one that is missing does not.
  "${root[@]}" apt-get update -q || die "apt-get update failed: is there a network?"
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}" ||
    die "These packages could not be installed: ${missing[*]}"
}

# Jobs that fit: a core each, and 2 GB of memory each (Ceres' and Eigen's templates take more than 1 GB).
job_count() {
  local cores memory
  cores=$(nproc)
  memory=$(awk '/^MemTotal/ { print int($2 / 2000000) }' /proc/meminfo)
  [ "$memory" -ge 1 ] || memory=1
  echo $((cores < memory ? cores : memory))
}

# configure DIRECTORY OPTIONS...: a build tree, by Ninja and ccache where they are.  The generator of a tree
# that is there already is kept.
configure() {
  local directory=$1 generator=()
  shift
  if [ ! -f "$directory/CMakeCache.txt" ] && command -v ninja >/dev/null; then generator=(-G Ninja); fi
  if command -v ccache >/dev/null; then
    # What was compiled in another folder is found again in this one.
    export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
    set -- "$@" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache
  fi
  say "Configuring $directory"
  cmake -S . -B "$directory" "${generator[@]}" "$@" >"$directory.configure.log" 2>&1 ||
    { cat "$directory.configure.log" >&2; die "Configuring $directory failed"; }
  mv "$directory.configure.log" "$directory/configure.log"
}

# build DIRECTORY OPTIONS...: e.g. --target graticule_cli.
build() {
  local directory=$1
  shift
  say "Building $directory with $(job_count) jobs"
  cmake --build "$directory" --parallel "$(job_count)" "$@"
}

# The branch as it is, whoever owns it: a container's checkout often belongs to somebody else.
export CTEST_OUTPUT_ON_FAILURE=1
