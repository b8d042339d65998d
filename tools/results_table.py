#!/usr/bin/env python3
"""Prints the cases of result files as the Markdown tables of docs/results.

usage: tools/results_table.py RESULTS.json… [--baseline CASE_PREFIX]     (default: vk/vertex/uc, the same raster mode)
"""
import collections
import json
import os
import sys


def rows(results, baseline):
    median = {case["id"]: case["gpu_ms"]["median"] for case in results["cases"] if case["gpu_ms"]}
    for case in results["cases"]:
        suffix = "" if case["raster"] == "full" else "+" + case["raster"]
        base = median.get(baseline + suffix)
        times = case["gpu_ms"]
        if case["status"] == "skipped":
            continue
        if not times:
            yield f"| `{case['id']}` | – | – | – | – | – | {case['status']}: {case['reason']} |"
            continue
        ratio = f"{times['median'] / base:.3f}" if base else "–"
        memory = case["memory_bytes"]["total"] / 1024
        error = case["accuracy"]["max_position_error"]
        yield (f"| `{case['id']}` | {times['median']:.3f} | {times['cv'] * 100:.2f} | {ratio} | {memory:,.0f} "
               f"| {error:.1e} | {case['status']} |")


def main(arguments):
    baseline = "vk/vertex/uc"
    if "--baseline" in arguments:
        at = arguments.index("--baseline")
        baseline = arguments[at + 1]
        del arguments[at:at + 2]
    for path in arguments:
        with open(path) as file:
            results = json.load(file)
        scene, settings = results["scene"], results["settings"]
        names = ", ".join(sorted({f"{d['name']} ({d['driver']})" for d in results["devices"]}))
        print(f"### {os.path.basename(path)}\n\n**{scene['name']}**: {scene['vertices']:,} vertices, {scene['triangles']:,} triangles, "
              f"{scene['joints']} joints; {settings['copies']} copies, {settings['width']}x{settings['height']}, "
              f"{settings['frames']} frames in {settings['rounds']} rounds; {names}; revision "
              f"`{results['tool']['revision']}`\n")
        print(f"| case | median ms | cv % | ratio to `{baseline}` | KiB a copy | position error | status |")
        print("|---|---:|---:|---:|---:|---:|---|")
        print("\n".join(rows(results, baseline)) + "\n")
        skipped = collections.Counter(case["reason"] for case in results["cases"] if case["status"] == "skipped")
        for reason, count in skipped.items():
            print(f"- {count} skipped: {reason}")
        if skipped:
            print()


main(sys.argv[1:])
