#!/usr/bin/env bash
# Runs every fuzzer, or those named, for SKINBENCH_FUZZ_SECONDS (60), two at a time. What they learn stays in
# BUILD/fuzz/TARGET for the next call; inputs that failed are named at the end.
# usage: tests/fuzz/run.sh BUILD [TARGET…]     (./test --fuzz [TARGET…])
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$1
shift
programs=$build/tests/fuzz
work=$build/fuzz
seconds=${SKINBENCH_FUZZ_SECONDS:-60}
export ASAN_OPTIONS=${ASAN_OPTIONS:-quarantine_size_mb=32} UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1}

[ $# -gt 0 ] || set -- $(cd "$programs" && ls -d fuzz_* | sed -n 's/^fuzz_\([a-z_]*\)$/\1/p')
"$programs/write_corpus" "$work/seeds"
mkdir -p "$work/found"

run() {
    mkdir -p "$work/$1"
    local folders=("$work/$1" "$work/seeds/$1")
    [ ! -d "$here/regressions/$1" ] || folders+=("$here/regressions/$1")
    "$programs/fuzz_$1" -max_total_time="$seconds" -rss_limit_mb=1024 -timeout=10 -max_len=1048576 \
        -print_final_stats=1 -artifact_prefix="$work/found/$1-" "${folders[@]}" >"$work/$1.log" 2>&1
}

failed=0
for target; do
    [ "$(jobs -rp | wc -l)" -lt 2 ] || wait -n || true
    echo "skinbench: fuzzing $target for $seconds s" >&2
    (run "$target" && echo 0 >"$work/$target.status" || echo 1 >"$work/$target.status") &
done
wait
for target; do
    printf '%-10s %s executions\n' "$target" \
        "$(sed -n 's/^stat::number_of_executed_units: *//p' "$work/$target.log" | grep . || echo '?')"
    [ "$(cat "$work/$target.status")" = 0 ] && continue
    failed=1
    echo "skinbench: the fuzzer $target failed; its log is $work/$target.log, its input" \
        "$(sed -n 's/.*Test unit written to //p' "$work/$target.log" | tail -n 1)" >&2
done
exit "$failed"
