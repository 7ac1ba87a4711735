#!/bin/sh
# Builds the program and installs it with its manual and the completion of shells: for root in /usr/local, else in
# ~/.local.
# Usage: scripts/install.sh [PREFIX]
set -eu
cd "$(dirname "$0")/.."
if [ "$(id -u)" -eq 0 ]; then prefix=/usr/local; else prefix="$HOME/.local"; fi
prefix=${1:-$prefix}
scripts/build.sh program
cmake --install build/program --component program --prefix "$prefix" >/dev/null
case ":$PATH:" in
  *":$prefix/bin:"*) echo "rayfield is installed in $prefix/bin" >&2 ;;
  *) echo "rayfield is installed in $prefix/bin, which is not on PATH: export PATH=\"$prefix/bin:\$PATH\"" >&2 ;;
esac
