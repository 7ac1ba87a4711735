#!/bin/sh
# Installs the packages of a preset of CMakePresets.json, configures it and builds it in build/PRESET.
# Usage: scripts/build.sh [PRESET] [ARGUMENT...]   (default: release; the arguments go to cmake --build)
set -eu
cd "$(dirname "$0")/.."
preset=${1:-release}
[ $# -gt 0 ] && shift
case "$preset" in
  program) lists="user" ;;
  fuzz) lists="user test check" ;;
  *) lists="user test" ;;
esac
# shellcheck disable=SC2086  # a list of words is meant
scripts/setup.sh $lists
# Checkouts in other folders share what is compiled.
export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1
# `program` needs no ccache, but uses one that is there; the other presets ask for it by name.
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER="${CMAKE_CXX_COMPILER_LAUNCHER:-ccache}"; fi
cmake --preset "$preset" >/dev/null
cmake --build "build/$preset" "$@"
