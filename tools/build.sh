#!/usr/bin/env bash
# Configures and builds one target of a preset, silently when nothing is to do, then runs a command. Called inside
# tools/enter.
# usage: tools/build.sh PRESET TARGET [COMMAND ARGS…]     ({build} in COMMAND stands for the build folder)
set -euo pipefail
repo=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
preset=$1
target=$2
shift 2
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}  # or it keeps nothing of precompiled headers
build=$repo/build/${SKINBENCH_ENVIRONMENT:-native}-$preset

if [ ! -f "$build/build.ninja" ]; then
    mkdir -p "$repo/build"
    if ! cmake -S "$repo" --preset "$preset" -B "$build" >"$build.log" 2>&1; then
        grep -A 6 'CMake Error' "$build.log" | head -n 20 >&2
        echo "skinbench: cmake could not configure $build; $build.log says why" >&2
        exit 1
    fi
fi
if ! ninja -C "$build" -n "$target" 2>/dev/null | grep -q 'no work to do'; then
    echo "skinbench: building $target in $build" >&2
    ninja -C "$build" "$target" >&2
fi
[ $# -gt 0 ] || exit 0
exec "${@//\{build\}/$build}"
