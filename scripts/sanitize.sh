#!/bin/sh
# Unit tests under sanitizers.
# Usage: scripts/sanitize.sh [asan-ubsan | tsan] [ROOM...]   (default: asan-ubsan, all rooms; e.g. tsan core libtile)
#
# asan-ubsan: AddressSanitizer and UndefinedBehaviorSanitizer. tsan: ThreadSanitizer; GCC's OpenMP runtime is not built
# with it, which core/parallel/thread_sanitizer.h makes up for. What libraries do is in tsan-suppressions.txt. Rooms are
# folders, in the order of CMakeLists.txt; each needs those that it uses.
set -eu
cd "$(dirname "$0")/.."
preset=${1:-asan-ubsan}
[ $# -gt 0 ] && shift
[ $# -gt 0 ] || set -- core libtile libdensity formats libslam libalign sim experiments cli
case "$preset" in
  asan-ubsan)
    # Leaks are not looked for: libraries that keep tables until the process ends would be reported.
    export ASAN_OPTIONS="detect_leaks=0:${ASAN_OPTIONS:-}"
    export UBSAN_OPTIONS="halt_on_error=1:print_stacktrace=1:${UBSAN_OPTIONS:-}"
    ;;
  tsan)
    export TSAN_OPTIONS="halt_on_error=1:second_deadlock_stack=1:suppressions=$PWD/scripts/tsan-suppressions.txt:${TSAN_OPTIONS:-}"
    ;;
  *) echo "sanitize.sh: no such preset: $preset (asan-ubsan, tsan)" >&2; exit 2 ;;
esac
scripts/build.sh "$preset" "-DRAYFIELD_ROOMS=$(echo "$*" | tr ' ' ';')"
ctest --test-dir "build/$preset" -L unit --output-on-failure --no-tests=error -j2
