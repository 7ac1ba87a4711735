#!/bin/sh
# Checks that need no build: format and links; with the argument `lint` also clang-tidy over every source.
# Usage: scripts/check.sh [format] [links] [lint [ARGUMENT...]]   (default: format links; ARGUMENT: of scripts/lint.py)
set -eu
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || set -- format links
scripts/setup.sh check
while [ $# -gt 0 ]; do
  check=$1
  shift
  case "$check" in
    format)
      git ls-files '*.h' '*.cpp' | xargs clang-format-14 --dry-run -Werror
      echo "format: $(git ls-files '*.h' '*.cpp' | wc -l) files clean"
      ;;
    links) scripts/check_links.py ;;
    lint)
      scripts/setup.sh user test  # headers, for the compile commands
      scripts/lint.py "$@"
      exit
      ;;
    *) echo "check.sh: no such check: $check (format, links, lint)" >&2; exit 2 ;;
  esac
done
