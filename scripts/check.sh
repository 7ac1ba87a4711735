#!/bin/bash
# Format; with the argument `lint` also clang-tidy over everything. Installs clang-format-14 and clang-tidy-14.
set -euo pipefail
cd "$(dirname "$0")/.."
for tool in clang-format clang-tidy; do
  if ! command -v $tool-14 >/dev/null && ! command -v $tool >/dev/null; then
    as_root=""; [ "$(id -u)" -eq 0 ] || as_root=sudo
    $as_root apt-get update >&2
    DEBIAN_FRONTEND=noninteractive $as_root apt-get install -y --no-install-recommends clang-format-14 clang-tidy-14 >&2
    break
  fi
done
find_tool() { command -v "$1-14" || command -v "$1"; }
clang_format=$(find_tool clang-format)
clang_tidy=$(find_tool clang-tidy)
mapfile -t files < <(git ls-files '*.h' '*.cpp')
"$clang_format" --dry-run -Werror "${files[@]}"
echo "format: ${#files[@]} files clean"
if [ "${1:-}" = lint ]; then
  mapfile -t sources < <(git ls-files '*/src/*.cpp')
  printf '%s\n' "${sources[@]}" | xargs -P2 -n4 "$clang_tidy" -p build/release --quiet 2>/dev/null
  echo "lint: ${#sources[@]} files clean"
fi
