#!/bin/sh
# Builds the `release` preset (or the preset named as first argument): packages, configure, compile.
set -eu
cd "$(dirname "$0")/.."
scripts/setup.sh
preset=${1:-release}
[ $# -gt 0 ] && shift
# Checkouts in other folders share what is compiled.
export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1
cmake --preset "$preset" >/dev/null
cmake --build "build/$preset" "$@"
