#!/bin/sh
# From a bare Debian 12 to the result of all tests.
# Usage: scripts/test.sh [ARGUMENT...]   (arguments go to ctest, e.g. -L unit)
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh release
ctest --test-dir build/release --output-on-failure --no-tests=error -j2 "$@"
