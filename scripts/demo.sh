#!/bin/sh
# From a bare Debian 12 to maps: installs packages, builds the program alone and installs it (scripts/install.sh),
# simulates a small vineyard at three dates and maps it.
# Usage: scripts/demo.sh [DIR]   (default: out/demo)
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh
exec build/program/cli/rayfield demo "${1:-out/demo}" --overwrite
