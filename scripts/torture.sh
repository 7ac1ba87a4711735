#!/bin/sh
# Attacks the program and its stores: kills, power cuts, failing system calls, full disks, damage, many writers, hostile
# input (tests/torture/torture.py, which has the options). A nonzero exit code means that something was found.
# Usage: scripts/torture.sh [MINUTES] [OPTION...]   (default: 10)
set -eu
cd "$(dirname "$0")/.."
minutes=${1:-10}
[ $# -gt 0 ] && shift
scripts/setup.sh user test check
scripts/build.sh release --target rayfield store_damage
folder=$(mktemp -u "${TMPDIR:-/tmp}/rayfield-torture.XXXXXX")
exec python3 tests/torture/torture.py build/release/cli/rayfield "$folder" --minutes "$minutes" "$@"
