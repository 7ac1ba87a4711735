#!/bin/sh
# Installs the packages of a preset of CMakePresets.json, configures it and builds it in build/PRESET.
# Usage: scripts/build.sh [PRESET] [-DVARIABLE=VALUE...] [ARGUMENT...]   (default: release; ARGUMENT: of cmake --build)
set -eu
cd "$(dirname "$0")/.."
preset=${1:-release}
[ $# -gt 0 ] && shift
case "$preset" in
  program) scripts/setup.sh user ;;
  fuzz) scripts/setup.sh user test check ;;
  *) scripts/setup.sh user test ;;
esac
# Checkouts in other folders share what is compiled.
export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1
# `program` needs no ccache, but uses one that is there; the other presets ask for it by name.
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER="${CMAKE_CXX_COMPILER_LAUNCHER:-ccache}"; fi
settings=""
while [ $# -gt 0 ] && [ "${1#-D}" != "$1" ]; do
  settings="$settings $1"
  shift
done
# shellcheck disable=SC2086  # settings are words without blanks
cmake --preset "$preset" $settings >/dev/null
cmake --build "build/$preset" "$@"
