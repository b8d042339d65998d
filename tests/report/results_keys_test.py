#!/usr/bin/env python3
"""Compares docs/results-file.md with files that the program has just made: a key or column that only one of the two
has is an error, and so is null where the page says never.     usage: results_keys_test.py SKINBENCH PAGE FOLDER"""
import csv
import json
import os
import re
import shutil
import subprocess
import sys

program, page = sys.argv[1:3]
folder = os.path.join(sys.argv[3], "files")  # alone is cleared
SMALL = ["--copies", "1", "--frames", "2", "--size", "64x64"]
RUNS = {  # skipped, prepass and host-skinned cases; several views and queues; pairs and limits
    "cases": ["--routes", "cpu,vk,vk-ext,vk-nv", "--variants", "vertex,cpu,mesh-ci", "--scenario", "prepass",
              "--compute", "plain"],
    "culling": ["--routes", "vk", "--variants", "compute-cull", "--cluster-cull", "list", "--cluster-bounds", "instance",
                "--views", "2", "--queues", "one,async"],
    "pairs": ["--routes", "cpu,vk-ext", "--variants", "cpu,mesh", "--self-test"],
}


def tables(text):
    """Per chapter of the page, key -> cell of the column `null` ("" where there is none)."""
    chapters = {}
    for chapter in re.split(r"^## ", text, flags=re.M)[1:]:
        name = chapter.split("\n", 1)[0]
        found = chapters[name] = {}
        for part in re.split(r"^### ", chapter, flags=re.M):
            title = part.split("\n", 1)[0]
            prefixes = [prefix + "." for prefix in re.findall(r"`([^`]+)`", title)] or [""]
            rows = [re.split(r" *\| *", row) for row in re.findall(r"^\| (`.*) \|$", part, flags=re.M)]
            for row in rows:
                for key in re.findall(r"`([^`]+)`", row[0]):
                    for prefix in prefixes if part != chapter else [""]:
                        assert prefix + key not in found, f"{name}: {prefix + key} is there twice"
                        found[prefix + key] = row[2] if len(row) == 4 else ""
    return chapters


def walk(value, path, keys):
    """Adds path -> its values; [] stands for every element of a list."""
    if isinstance(value, dict):
        for key, inner in value.items():
            inner_path = f"{path}.{key}" if path else key
            keys.setdefault(inner_path, []).append(inner)
            walk(inner, inner_path, keys)
    elif isinstance(value, list):
        for inner in value:
            walk(inner, path + "[]", keys)
    return keys


def parent(path):
    return path.rpartition(".")[0]


def compare(name, described, keys, opaque):
    """`opaque`: whether what lies below a path is described in words."""
    parents = {parent(path) for path in keys}
    faults = [f"{path} is in the file, not on the page" for path in keys
              if path not in described and not any(opaque(up) for up in ancestors(path))]
    # Below an object that is null, or a list that is empty, in every file there is nothing to compare with.
    faults += [f"{path} is on the page, not in the file" for path in described
               if path not in keys and parent(path) in parents]
    faults += [f"{path} is null, and the page says never" for path, null in described.items()
               if null == "never" and None in keys.get(path, [])]
    assert not faults, f"{name}: " + "; ".join(faults)
    return sum(path in keys for path in described)


def ancestors(path):
    while path := parent(path):
        yield path


def columns_of(paths, axes):
    """The columns that the values of a case make: an interval two, a list none."""
    for path in paths:
        name = path.removeprefix("cases[].")
        of_list = name.endswith((".samples", ".round_sizes"))
        if of_list or name in ("id", "options", *axes) or path in map(parent, paths):
            continue
        ends = ("_low", "_high") if name.endswith(".interval") else ("",)
        yield from (name.replace(".", "_") + end for end in ends)


def run(*arguments):
    return subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout


shutil.rmtree(folder, ignore_errors=True)
os.makedirs(folder)
os.chdir(folder)
with open(page) as file:
    chapters = tables(file.read())

keys = {}
for name, selectors in RUNS.items():
    subprocess.run([program, "bench", "builtin:robot:2000", *selectors, *SMALL, "--out", name],
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # status 1: pairs may differ by chance
    with open(f"{name}/results.json") as file:
        written = json.load(file)
    walk(written, "", keys)
results = chapters["results.json"]
count = compare("results.json", results, keys, lambda path: path == "cases[].options")
assert count > 150, f"only {count} keys were compared"

axes = [axis["name"] for axis in written["axes"]]
inner = {axis["name"] for axis in written["axes"] if not axis["top_level"]} | {"meshlet_vertices", "meshlet_triangles"}
unknown = {path.rpartition(".")[2] for path in keys if parent(path) == "cases[].options"} - inner
missing = {axis["name"] for axis in written["axes"] if axis["top_level"] and "cases[]." + axis["name"] not in keys}
assert not unknown and not missing, f"no rows of axes: {unknown}; no keys of a case: {missing}"

with open("cases/results.csv") as file:
    header = next(csv.reader(file))
columns = ["scene", "device", "id", *axes, *columns_of({path for path in results if path.startswith("cases[].")}, axes)]
assert sorted(header) == sorted(columns), f"results.csv: {set(header) ^ set(columns)}"

of_device = {path: null for path, null in results.items()
             if path.startswith("devices[].") and not path.startswith("devices[].peak")}
of_scene = {path: null for path, null in results.items() if path.startswith("scene.")}
for name, arguments, more in (("bench --list", ["--variants", "vertex,mesh", "--routes", "vk,cpu"], {}),
                              ("probe", [], of_device),
                              ("inspect", ["builtin:robot:2000"], of_scene),
                              ("partition", ["builtin:robot:2000", "--hardware", "generic"], {}),
                              ("compare", ["cases/results.json", "cases/results.json"], {})):
    described = chapters[f"{name} --json"] | more
    listed = {parent(path) for path in described}
    found = walk(json.loads(run(*name.split(), *arguments, "--json")), "", {})
    count += compare(name, described, found, lambda path: path not in listed and path + "[]" not in listed)
print(f"{count} keys and {len(header)} columns, as {os.path.basename(page)} says")
