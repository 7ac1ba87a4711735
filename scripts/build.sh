#!/bin/sh
# Builds the `release` preset (or the preset named as first argument): packages, configure, compile.
set -eu
cd "$(dirname "$0")/.."
scripts/setup.sh
preset=${1:-release}
[ $# -gt 0 ] && shift
cmake --preset "$preset" >/dev/null
cmake --build "build/$preset" "$@"
