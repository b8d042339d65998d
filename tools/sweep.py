#!/usr/bin/env python3
"""Runs `verify` over a folder of foreign glTF files, one process each, and sums up what was refused and why.

Where node finds Khronos' glTF validator (npm package gltf-validator, through NODE_PATH or --validator), what each of
the two accepts is compared. Exit status: 1 where the program crashed, ran out of time or failed on a file.
"""
import argparse
import collections
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys

REPOSITORY = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
VALIDATOR = """
const fs = require('fs'), path = require('path'), validator = require('gltf-validator'), file = process.argv[1];
if (!file) process.exit(0);
const read = uri => new Uint8Array(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri))));
validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
    uri: path.basename(file), maxIssues: 100000, externalResourceFunction: async uri => read(uri)
}).then(report => {
    const errors = report.issues.messages.filter(message => message.severity === 0);
    console.log(JSON.stringify(errors.map(message => message.code)));
}, error => console.log(JSON.stringify(['NO_GLTF: ' + error])));
"""


def run(words, seconds, bytes_, **options):
    """Exit status, standard output and standard error; the status is text where a limit or a signal ended it."""
    limits = lambda: resource.setrlimit(resource.RLIMIT_AS, (bytes_, bytes_)) if bytes_ else None
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL,
                               start_new_session=True, preexec_fn=limits, **options)
    try:
        out, err = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        out, err = process.communicate()
        return f"took more than {seconds} s", "", ""
    status = process.returncode
    if status < 0 or status > 128:
        status = "ended by " + signal.Signals(-status if status < 0 else status - 128).name
    return status, out.decode(errors="replace"), err.decode(errors="replace")


def kind_of(message, path):
    """The message without what differs from file to file."""
    name = os.path.basename(path)
    message = message.replace(name, "FILE").replace(os.path.splitext(name)[0], "FILE")
    message = re.sub(r'"[^"]*"|\'[^\']*\'', '"…"', message)
    message = re.sub(r"(?<![A-Za-z_])[-+]?\d+(\.\d+)?(e[-+]?\d+)?", "N", message)
    return re.sub(r"^(warning: )?(FILE: )+", "", message)


def verify(program, path, arguments):
    words = [*program, "verify", path, "--copies", "1", *(["--routes", "cpu"] if arguments.cpu else [])]
    status, _, err = run(words, arguments.seconds, arguments.memory << 20)
    lines = [line.removeprefix("skinbench: ") for line in err.splitlines() if line.startswith("skinbench: ")]
    if status == 2 and lines:
        return "refused", kind_of(lines[-1], path), lines
    if status == 0:
        return "loaded", "", lines
    return "broken", kind_of(lines[-1], path) if status == 1 and lines else f"status {status}", lines


def validate(path, environment, seconds):
    """Codes of errors, or None."""
    status, out, _ = run(["node", "-e", VALIDATOR, os.path.abspath(path)], seconds, 0, env=environment)
    return sorted(set(json.loads(out))) if status == 0 and out else None


def validator_environment(folder):
    """None where node does not find the validator."""
    paths = [path for path in (folder, os.environ.get("NODE_PATH")) if path]
    environment = os.environ | {"NODE_PATH": os.pathsep.join(paths)}
    if shutil.which("node") and run(["node", "-e", VALIDATOR], 60, 0, env=environment)[0] == 0:
        return environment
    print("sweep: node does not find gltf-validator (npm install gltf-validator; --validator NODE_MODULES), so files "
          "are not compared with it", file=sys.stderr)
    return None


def print_groups(title, groups):
    if not groups:
        return
    print(f"\n{title}")
    for kind, paths in sorted(groups.items(), key=lambda group: (-len(group[1]), group[0])):
        print(f"{len(paths):6}  {kind}\n        {paths[0]}" + (f" and {len(paths) - 1} more" if paths[1:] else ""))


def grouped(rows, key):
    groups = collections.defaultdict(list)
    for row in rows:
        for kind in key(row):
            groups[kind].append(row["file"])
    return groups


def summarise(rows, validated):
    count = collections.Counter(row["result"] for row in rows)
    print(f"{len(rows)} files: {count['loaded']} loaded, {count['refused']} refused, {count['broken']} neither")
    by = lambda result, good=None: [row for row in rows if row["result"] == result and
                                    (good is None or (row["errors"] is not None and (not row["errors"]) == good))]
    print_groups("Neither loaded nor refused:", grouped(by("broken"), lambda row: [row["why"]]))
    print_groups("Refused:", grouped(by("refused"), lambda row: [row["why"]]))
    print_groups("Warnings:", grouped(rows, lambda row: {kind_of(line, row["file"]) for line in row["lines"]}
                                      if row["result"] == "loaded" else []))
    if not validated:
        return
    print_groups("Valid for Khronos' validator, but refused:", grouped(by("refused", True), lambda row: [row["why"]]))
    silent = [row for row in by("loaded", False) if not row["lines"]]
    print_groups("Loaded without a warning, with errors of the validator:", grouped(silent, lambda row: row["errors"]))
    print(f"\nagreed: {len(by('loaded', True))} loaded and valid, {len(by('refused', False))} refused and not valid")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", metavar="FOLDER")
    parser.add_argument("--cpu", action="store_true", help="only the route cpu, where there is no driver")
    parser.add_argument("--seconds", type=int, default=60, help="limit of each file (%(default)s)")
    parser.add_argument("--memory", type=int, default=8192, help="address space of each file in MiB (%(default)s)")
    parser.add_argument("--program", help="a built skinbench; else it is built and entered as ./run does")
    parser.add_argument("--validator", metavar="NODE_MODULES", help="the folder that npm installed the validator in")
    parser.add_argument("--json", metavar="FILE", help="also write a row for each file")
    arguments = parser.parse_args()

    enter = os.path.join(REPOSITORY, "tools", "enter")
    program = [arguments.program] if arguments.program else [enter, subprocess.run(
        [enter, os.path.join(REPOSITORY, "tools", "build.sh"), "release", "skinbench", "echo", "{build}/skinbench"],
        check=True, stdout=subprocess.PIPE, text=True).stdout.strip()]
    environment = validator_environment(arguments.validator)
    paths = sorted(os.path.join(folder, name) for top in arguments.folders for folder, _, names in os.walk(top)
                   for name in names if name.lower().endswith((".glb", ".gltf", ".vrm")))
    sys.stdout.reconfigure(errors="replace")  # names need not be UTF-8
    rows = []
    for number, path in enumerate(paths):
        if sys.stderr.isatty():
            print(f"\r{number + 1}/{len(paths)} ", end="", file=sys.stderr, flush=True)
        result, why, lines = verify(program, path, arguments)
        errors = validate(path, environment, arguments.seconds) if environment else None
        rows.append({"file": path, "result": result, "why": why, "lines": lines, "errors": errors})
    if sys.stderr.isatty():
        print("\r", end="", file=sys.stderr)
    summarise(rows, environment is not None)
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(rows, file, indent=1)
    sys.exit(1 if any(row["result"] == "broken" for row in rows) else 0)


if __name__ == "__main__":
    main()
