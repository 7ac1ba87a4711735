#!/bin/sh
# Installs a build into an empty folder, looks whether all is there that comes with the program, and builds a project of
# its own against it with find_package(rayfield).
# Usage: tests/consumer/run.sh BUILD_FOLDER
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$1" --prefix "$work/prefix" >/dev/null
for file in bin/rayfield share/man/man1/rayfield.1.gz share/man/man1/rayfield-process.1.gz \
  share/bash-completion/completions/rayfield share/zsh/site-functions/_rayfield \
  share/fish/vendor_completions.d/rayfield.fish share/doc/rayfield/LICENSE share/doc/rayfield/docs/commands.md \
  share/doc/rayfield/examples/demo.toml; do
  [ -s "$work/prefix/$file" ] || { echo "not installed: $file" >&2; exit 1; }
done
cmake -S "$here" -B "$work/build" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$work/build" >/dev/null
"$work/build/consumer"
