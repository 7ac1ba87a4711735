#!/bin/bash
# Runs every libFuzzer target of tests/fuzz (preset `fuzz`) for some minutes each, one after the other, and prints what
# each has executed and found. Inputs that reach something new are kept in build/fuzz/corpus/TARGET and are where the
# next run begins; inputs that make a target fail are kept in build/fuzz/findings/TARGET. Exit code 1 if there are any.
# Usage: scripts/fuzz.sh [MINUTES] [TARGET...]   (default: 1 minute, all targets)
set -euo pipefail
cd "$(dirname "$0")/.."
minutes=${1:-1}
[ $# -gt 0 ] && shift
[[ $minutes =~ ^[0-9]+(\.[0-9]+)?$ ]] || { sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }
scripts/build.sh fuzz
programs=build/fuzz/tests/fuzz
if [ $# -eq 0 ]; then
  for source in tests/fuzz/fuzz_*.cpp; do set -- "$@" "$(basename "$source" .cpp)"; done
fi
"$programs/write_seeds" build/fuzz/corpus
# Leaks are not looked for: libraries that keep tables until the process ends would be reported.
export ASAN_OPTIONS="detect_leaks=0:${ASAN_OPTIONS:-}" UBSAN_OPTIONS="halt_on_error=1:print_stacktrace=1:${UBSAN_OPTIONS:-}"
seconds=$(awk -v minutes="$minutes" 'BEGIN { printf "%d", 60 * minutes }')

row="%-16s %12s %8s %8s %8s\n"
table=$(printf "$row" target executions "per s" corpus findings)
failed=0
for target in "$@"; do
  findings=build/fuzz/findings/$target log=build/fuzz/$target.log
  mkdir -p "$findings"
  words=tests/fuzz/$target.dict
  [ -f "$words" ] && words="-dict=$words" || words=-verbosity=1
  echo "== $target" >&2
  nice -n 10 "$programs/$target" -max_total_time="$seconds" -max_len=65536 -timeout=10 -rss_limit_mb=2048 \
    -print_final_stats=1 "$words" -artifact_prefix="$findings/" "build/fuzz/corpus/$target" >"$log" 2>&1 || tail -n 40 "$log" >&2
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log" | tail -1)
  rate=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log" | tail -1)
  kept=$(find "build/fuzz/corpus/$target" -type f | wc -l)
  found=$(find "$findings" -type f | wc -l)
  [ "$found" -eq 0 ] || failed=1
  [ -n "$executions" ] || { echo "fuzz.sh: $target did not run to its end: see $log" >&2; failed=1; }
  table+=$'\n'$(printf "$row" "$target" "${executions:-?}" "${rate:-?}" "$kept" "$found")
done
echo "$table"
exit $failed
