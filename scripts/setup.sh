#!/bin/sh
# Installs the Debian packages of scripts/packages.txt that are missing. Needs root, or sudo.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
missing=""
for package in $(sed 's/#.*//' "$here/packages.txt"); do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing="$missing $package"
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
