#!/usr/bin/env python3
"""Runs the Python of docs/machines.md on two result files.     usage: results_query_test.py SKINBENCH MACHINES_MD FOLDER"""
import json
import os
import re
import shutil
import subprocess
import sys

program, page = sys.argv[1:3]
folder = os.path.join(sys.argv[3], "files")  # alone is cleared
shutil.rmtree(folder, ignore_errors=True)
os.makedirs(folder)
os.chdir(folder)
for name, copies in (("a", "2"), ("b", "3")):
    subprocess.run([program, "bench", "builtin:robot:2000", "--routes", "cpu", "--influences", "4,8", "--copies", copies,
                    "--frames", "6", "--out", f"results/{name}"], check=True, stdout=subprocess.DEVNULL)

with open(page) as file:
    blocks = re.findall(r"```python\n(.*?)```", file.read(), re.S)
assert len(blocks) == 2, "docs/machines.md has not its two blocks"
scope = {}
exec(blocks[0], scope)
rows = list(scope["db"].execute("select scene, id, status, ms, bytes from cases"))

expected = []
for name in ("a", "b"):
    with open(f"results/{name}/results.json") as file:
        results = json.load(file)
    for case in results["cases"]:
        expected.append((results["scene"]["name"], case["id"], case["status"], case["gpu_ms"]["median"],
                         case["memory_bytes"]["total"]))
assert len(rows) == 4, rows
assert sorted(rows) == sorted(expected), (rows, expected)

printed = []
scope["print"] = printed.append
exec(blocks[1], scope)
assert [row[0] for row in printed] == [row[1] for row in sorted(
    {e[:2] + (min(x[3] for x in expected if x[:2] == e[:2]),) for e in expected}, key=lambda e: e[2])], printed
print(f"{len(rows)} cases of two files, as docs/machines.md says")
