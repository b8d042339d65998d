#!/usr/bin/env python3
"""Recomputes the ratios of docs/results/answers.md from the result files that it names.

usage: tools/answers.py ANSWERS_MD            fails where one differs
       tools/answers.py ANSWERS_MD --write    writes them anew, after another measurement
"""
import functools
import json
import os
import re
import sys

ROW = re.compile(r"^\| ([\d.]+) \| `([^`]+)` \| `([^`]+)` \| (?:(\w+) of )?`([^`]+)`(?:, `([^`]+)`)? \|$")


@functools.cache
def cases(path):
    with open(path) as file:
        return {case["id"]: case for case in json.load(file)["cases"]}


def value(path, identity, what):
    case = cases(path)[identity]
    return case["memory_bytes"]["total"] if what == "bytes" else case["gpu_ms"]["median"]


def ratio(folder, match):
    """A row: ratio, case, baseline, file of the case and, where it is another one, of the baseline."""
    _, case, baseline, what, file, other = match.groups()
    return (value(os.path.join(folder, file), case, what) /
            value(os.path.join(folder, other or file), baseline, what))


def rows(page):
    """Of every row its line number, its match and its ratio as it should be printed."""
    folder = os.path.dirname(page)
    with open(page) as file:
        for number, line in enumerate(file):
            if match := ROW.match(line.rstrip("\n")):
                yield number, match, f"{ratio(folder, match):.2f}"


def main(page, write):
    wrong = [(number, match, right) for number, match, right in rows(page) if match[1] != right]
    if write:
        with open(page) as file:
            lines = file.readlines()
        for number, match, right in wrong:
            lines[number] = lines[number].replace(f"| {match[1]} |", f"| {right} |", 1)
        with open(page, "w") as file:
            file.writelines(lines)
        wrong = []
    for number, match, right in wrong:
        print(f"{page}:{number + 1}: {match[2]} takes {right} of {match[3]}, not {match[1]}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], "--write" in sys.argv))
