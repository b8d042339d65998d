#!/usr/bin/env python3
"""Runs the commands of docs/ci.md on a small scene.     usage: ci_recipe_test.py SKINBENCH CI_MD FOLDER"""
import json
import os
import re
import shutil
import subprocess
import sys

program, page = sys.argv[1:3]
folder = os.path.join(sys.argv[3], "files")  # alone is cleared
shutil.rmtree(folder, ignore_errors=True)
os.makedirs(folder + "/bin")
os.symlink(os.path.abspath(program), folder + "/bin/skinbench")
with open(page) as file:
    blocks = re.findall(r"```sh\n(.*?)```", file.read(), re.S)
os.chdir(folder)
assert len(blocks) == 2, "docs/ci.md has not its two blocks"
environment = os.environ | {"PATH": os.path.abspath("bin") + ":" + os.environ["PATH"], "OLD": "builtin:robot:2000",
                            "NEW": "builtin:robot:2000", "CASES": "--routes cpu --influences 4,8 --copies 2"}


def shell(commands):
    return subprocess.run(["sh", "-ec", commands], env=environment, capture_output=True, text=True)


def results(name):
    with open(f"{name}/results.json") as file:
        return json.load(file)


def write(name, content):
    with open(f"{name}/results.json", "w") as file:
        json.dump(content, file)


measured = shell(blocks[0])
assert measured.returncode == 0, measured.stderr
for name in ("baseline", "new"):
    assert results(name)["settings"]["placement"] == "fresh"
    assert [len(case["gpu_ms"]["round_sizes"]) for case in results(name)["cases"]] == [8, 8]
compared = shell(blocks[1])
# How busy this machine was decides about the times of a CPU, not about what else the recipe says.
assert compared.returncode in (0, 1) and "is ok in" not in compared.stderr, compared.stderr
assert "cpu/cpu/uc " in compared.stdout and "cpu/cpu/uc+8-influences" in compared.stdout, compared.stdout

# A steady machine's times, against themselves and against twice of them.
slower = results("baseline")
for case in slower["cases"]:
    median = case["gpu_ms"]["median"]
    case["gpu_ms"]["samples"] = [median * (1 + i % 5 / 1000) for i in range(len(case["gpu_ms"]["samples"]))]
write("baseline", slower)
write("new", slower)
compared = shell(blocks[1])
assert compared.returncode == 0 and "no difference (2)" in compared.stdout, compared
for case in slower["cases"]:
    case["gpu_ms"]["median"] *= 2
    case["gpu_ms"]["samples"] = [2 * sample for sample in case["gpu_ms"]["samples"]]
write("new", slower)
compared = shell(blocks[1])
assert compared.returncode == 1, compared
assert re.search(r"of 2 cases (is|are) more than 5 % slower; the first, cpu/cpu/uc", compared.stderr), compared.stderr
print("docs/ci.md measures, passes and fails as it says")
