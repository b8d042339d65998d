#!/usr/bin/env bash
# Configures and builds one target of a preset, silently when nothing is to do, then runs a command. Called inside
# tools/enter. What cmake and ninja print goes to logs beside the build folder.
# usage: tools/build.sh PRESET TARGET [COMMAND ARGS…]     ({build} in COMMAND stands for the build folder)
set -euo pipefail
repo=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
preset=$1
target=$2
shift 2
build=$repo/build/${SKINBENCH_ENVIRONMENT:-native}-$preset

say() { printf 'skinbench: %s\n' "$*" >&2; }

# lasting SECONDS: in words.
lasting() {
    if [ "$1" -lt 90 ]; then echo "about $1 s"; else echo "about $((($1 + 30) / 60)) minutes"; fi
}

# Prints what ninja does; the numbers of its steps are shown on a terminal, in one line.
build_target() {
    if [ ! -t 2 ]; then
        ninja -C "$build" "$target" >"$build.ninja.log" 2>&1
    else
        ninja -C "$build" "$target" 2>&1 | tee "$build.ninja.log" |
            awk '/^\[/ { printf "\r%s ", $1; fflush() } END { printf "\r\033[K" }' >&2
    fi
}

mkdir -p "$repo/build"
exec 9>"$build.lock"
if ! flock -n 9; then
    say "waiting for another call that builds in $build"
    flock 9
fi
if [ ! -f "$build/build.ninja" ]; then
    say "configuring $build, $(lasting 10)"
    if ! cmake -S "$repo" --preset "$preset" -B "$build" >"$build.cmake.log" 2>&1; then
        missing=$(sed -n -e 's/.*configuration file provided by "\([^"]*\)".*/\1/p' \
            -e 's/.*Could NOT find \([^ ]*\).*/\1/p' "$build.cmake.log" | sed -n 1p)
        if [ -n "$missing" ]; then
            say "the build needs $missing, which is not installed here; tools/packages.txt lists all it needs"
        else
            grep -A 6 'CMake Error' "$build.cmake.log" | head -n 20 >&2
        fi
        say "cmake could not configure $build; all that it printed is in $build.cmake.log"
        exit 1
    fi
fi
# A file that is new is a step only once CMake has run again.
ninja -C "$build" build.ninja >"$build.ninja.log" 2>&1 || true
steps=$(ninja -C "$build" -n "$target" 2>/dev/null | sed -n 's,^\[[0-9]*/\([0-9]*\)\].*,\1,p' | tail -n 1)
if [ -n "$steps" ]; then
    # A file takes six seconds of one core, at the most; ccache knows many of them already.
    [ "$steps" = 1 ] && unit=step || unit=steps
    say "building $target in $build, $steps $unit, $(lasting $((steps * 6 / $(nproc) + 1))) at the most"
    if ! build_target; then
        sed -n '/^FAILED/,$p' "$build.ninja.log" | head -n 40 >&2
        say "$target could not be built; all that ninja printed is in $build.ninja.log"
        exit 1
    fi
fi
exec 9>&-
[ $# -gt 0 ] || exit 0
exec "${@//\{build\}/$build}"
