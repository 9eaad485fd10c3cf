#!/usr/bin/env bash
# Shared by run-demo and run-tests: Debian packages, configuring, building. Source it at the repository's root, or run it to set up and build.

# Where to build; a relative name counts from the source tree.
WHIRL_BUILD=${WHIRL_BUILD:-build}

# Names in package lists, comments and empty lines left out.
packages_in() { sed 's/#.*//' "$@" | tr -s ' \t\n' '\n' | sed '/^$/d'; }

missing_packages() {
  local installed
  installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' 2>/dev/null | sed -n 's/^installed //p' | sort -u)
  packages_in "$@" | sort -u | comm -23 - <(printf '%s\n' "$installed")
}

# install_packages LIST...: installs what is missing; one line on standard error and status 1 if that cannot be done.
install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    echo "setup: not a Debian system; taking for granted that what $* name is installed" >&2
    return 0
  fi
  local missing as_root=()
  missing=$(missing_packages "$@")
  [ -n "$missing" ] || return 0
  missing=$(echo $missing)
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "setup: missing packages; as root: apt-get install --no-install-recommends $missing" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  echo "setup: installing $missing" >&2
  "${as_root[@]}" apt-get update -qq >&2 || echo "setup: could not renew the package lists; trying with the old ones" >&2
  if ! "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >&2 </dev/null; then
    echo "setup: could not install: $missing" >&2
    return 1
  fi
}

# configure DIRECTORY BUILD_TYPE [cmake argument...]
configure() {
  local directory=$1 type=$2
  shift 2
  export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=true  # one clone's objects serve the next
  local launcher=()
  if command -v ccache >/dev/null; then launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
  cmake -S . -B "$directory" -G Ninja -DCMAKE_BUILD_TYPE="$type" -Wno-dev "${launcher[@]}" "$@"
}

# build DIRECTORY [target]
build() { cmake --build "$1" --parallel "$(nproc)" ${2:+--target "$2"}; }

if [ "${BASH_SOURCE[0]}" = "$0" ]; then
  set -euo pipefail
  cd "$(dirname "$0")/.."
  install_packages packages.txt
  configure "$WHIRL_BUILD" Release
  build "$WHIRL_BUILD"
fi
