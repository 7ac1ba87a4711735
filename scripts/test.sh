#!/bin/sh
# From a bare Debian 12 to the result of all tests.
# Usage: scripts/test.sh [ARGUMENT...]   (arguments go to ctest, e.g. -L unit)
#        scripts/test.sh --qgis [ARGUMENT...]   (opens an exported block in QGIS, which it installs, and nothing else;
#                                                arguments go to tests/cli/qgis_project/qgis_project.py)
set -eu
cd "$(dirname "$0")/.."
if [ "${1:-}" = --qgis ]; then
  shift
  scripts/setup.sh qgis
  scripts/build.sh release --target rayfield
  exec /usr/bin/python3 tests/cli/qgis_project/qgis_project.py build/release/cli/rayfield build/release/qgis_project "$@"
fi
scripts/build.sh release
ctest --test-dir build/release --output-on-failure --no-tests=error -j2 "$@"
