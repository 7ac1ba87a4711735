#!/bin/bash
# Hashes everything that rayfield makes of three inputs: the demonstration (simulated logs, clouds, truth, store, maps),
# both logs of the shared block_a (through SLAM to maps) and a simulated fixed 16-beam lidar (from its log, through SLAM
# to maps). A change that is meant to change no result is held against the program as it was before:
#
#   scripts/same-bytes.sh PROGRAM               prints "SHA-256  name" for every file, ordered by name
#   scripts/same-bytes.sh OLD_PROGRAM PROGRAM   runs both, prints what differs; exit code 1 if anything does
#
# Left out is what holds the time of the run or names its place: snapshots, and the timings in SLAM reports. Files in a
# store are named without the hashes in their names, so that a file whose content is the same under another key is the
# same.
# Needs about 3 GB in TMPDIR at a time. RAYFIELD_SHARED names the folder of the shared data (default: ../shared).
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
shared=${RAYFIELD_SHARED:-$root/../shared}
[ $# -ge 1 ] && [ $# -le 2 ] || { sed -n '2,13s/^# \{0,1\}//p' "$0" >&2; exit 2; }

# One site through the chain, from clouds or logs: map_site PROGRAM FOLDER CRS DATE=INPUT...
map_site() {
  local program=$1 folder=$2 crs=$3 scan; shift 3
  "$program" init "$folder/store" --crs "$crs" -q
  for scan in "$@"; do "$program" add "$folder/store" "${scan#*=}" --date "${scan%%=*}" -q; done
  "$program" process "$folder/store" -q
  "$program" export "$folder/store" -o "$folder/maps" --format geotiff,gpkg,geojson,csv,png -q
}

register() {  # register PROGRAM LOG RIG CRS STEM
  "$1" slam "$2" --rig "$3" --crs "$4" -o "$5.ply" --trajectory "$5.tum" --report "$5.json" --picture "$5.png" -q
}

hash_all() {  # hash_all FOLDER
  (cd "$1" && find . -type f ! -path '*/snapshots/*' ! -name lock ! -name store.json -print0 | sort -z |
    while IFS= read -r -d '' file; do
      local name
      name=$(sed -E 's/[.-][0-9a-f]{16,64}//g' <<<"${file#./}")
      case "$file" in  # the timings of SLAM reports are an array of their own
        *.json) sed -E 's/"stages":[[:space:]]*\[[^]]*\],?//' "$file" | sha256sum | sed "s|-\$|$name|" ;;
        *) sha256sum <"$file" | sed "s|-\$|$name|" ;;
      esac
    done) | sort -k2
}

make_everything() {  # make_everything PROGRAM FOLDER
  local program=$1 out=$2
  "$program" demo "$out/demo" -q
  "$program" simulate "$root/sim/sites/multi_beam.toml" -o "$out/multi_beam" -q
  local log="$out/multi_beam/2019-12-20"
  register "$program" "$log/scan.bag" "$log/rig.toml" EPSG:7855 "$out/multi_beam/registered"
  map_site "$program" "$out/multi_beam" EPSG:7855 "2019-12-20=$out/multi_beam/registered.ply"
  if [ -d "$shared/data/block_a" ]; then
    mkdir "$out/block_a"
    local date scans=()
    for date in 2018-12-12 2019-02-11; do
      register "$program" "$shared/data/block_a/$date/scan.bag" "$shared/data/block_a/$date/rig.toml" EPSG:7854 "$out/block_a/$date"
      scans+=("$date=$out/block_a/$date.ply")
    done
    map_site "$program" "$out/block_a" EPSG:7854 "${scans[@]}"
  else
    echo "same-bytes.sh: no $shared/data/block_a: its logs are left out" >&2
  fi
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
number=0
for program in "$@"; do
  number=$((number + 1))
  mkdir "$work/run"  # the same place for both: commands and paths become part of some files
  make_everything "$(realpath "$program")" "$work/run" >&2
  hash_all "$work/run" >"$work/$number.txt"
  rm -rf "$work/run"
done
if [ $# -eq 1 ]; then
  cat "$work/1.txt"
elif diff "$work/1.txt" "$work/2.txt"; then
  echo "same bytes: $(wc -l <"$work/1.txt") files, $(sha256sum <"$work/1.txt" | cut -c1-16)"
else
  echo "not the same: $(diff "$work/1.txt" "$work/2.txt" | grep -c '^>') of $(wc -l <"$work/2.txt") files differ" >&2
  exit 1
fi
