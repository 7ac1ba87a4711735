#!/bin/sh
# Installs what is missing of lists of Debian packages. Needs root, or sudo.
# Usage: scripts/setup.sh [LIST...]   LIST: user (packages.txt; the default), test, check, qgis (packages-LIST.txt)
set -eu
here=$(cd "$(dirname "$0")" && pwd)
[ $# -gt 0 ] || set -- user
missing=""
for list in "$@"; do
  case "$list" in
    user) file="$here/packages.txt" ;;
    test | check | qgis) file="$here/packages-$list.txt" ;;
    *) echo "setup.sh: no such list: $list (user, test, check, qgis)" >&2; exit 2 ;;
  esac
  for package in $(sed 's/#.*//' "$file"); do
    status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$status" = installed ] || missing="$missing $package"
  done
done
[ -n "$missing" ] || exit 0
as_root=""
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "setup.sh: root or sudo is needed to install:$missing" >&2; exit 1; }
  as_root=sudo
fi
echo "Installing:$missing" >&2
$as_root apt-get update >&2
# shellcheck disable=SC2086  # a list of words is meant
DEBIAN_FRONTEND=noninteractive $as_root apt-get install -y --no-install-recommends $missing >&2
