#!/usr/bin/env python3
"""Checks what the docs name: links and their headings, files of the repository, figures of result files.

usage: docs_test.py REPOSITORY
"""
import glob
import os
import re
import sys

repository = os.path.abspath(sys.argv[1])
os.chdir(repository)
sys.path.insert(0, "tools")
sys.dont_write_bytecode = True
import answers  # noqa: E402

PAGES = ["README.md", *sorted(glob.glob("docs/**/*.md", recursive=True))]
FOLDERS = ("apps", "backend_gl", "backend_vulkan", "common", "docs", "shaders_glsl", "tests", "tools")
faults = []


def check(condition, what):
    if not condition:
        faults.append(what)


def read(path):
    with open(path) as file:
        return file.read()


def without_code(text):
    return re.sub(r"```.*?```", "", text, flags=re.S)


def anchors(page):
    """The anchors that GitHub makes of a page's headings."""
    headings = re.findall(r"^#+ (.*)$", without_code(read(page)), re.M)
    return {re.sub(r"[^\w\- ]", "", re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading)).lower().replace(" ", "-")
            for heading in headings}


def check_links(page):
    links = re.findall(r"\]\(([^)\s]+)\)|^\[\w+\]: (\S+)$", without_code(read(page)), re.M)
    links = [inline or reference for inline, reference in links]
    for link in links:
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
        check(os.path.exists(target), f"{page} links to {link}, which does not exist")
        if anchor and target.endswith(".md") and os.path.exists(target):
            check(anchor in anchors(target), f"{page} links to {link}, and {target} has no such heading")
    return len(links)


def check_names(page):
    """Paths in code, such as `common/cases/axes.cpp`; a name in capitals or a * stands for any."""
    names = re.findall(rf"`(?:\./)?((?:{'|'.join(FOLDERS)})/[\w./*-]*)[` ]", read(page))
    for name in names:
        pattern = re.sub(r"[A-Z]{4,}", "*", name) if not os.path.exists(name) else name
        check(glob.glob(pattern), f"{page} names {name}, which does not exist")
    return len(names)


def check_answers():
    page = "docs/results/answers.md"
    known = set()
    for number, match, right in answers.rows(page):
        check(match[1] == right, f"{page}:{number + 1}: the ratio is {right}, not {match[1]}")
        known.add(right)
    check(len(known) > 10, f"{page} has no ratios")
    # What the two pages say first, before the next heading.
    results = read("docs/results/README.md").split("\n## ")[1]
    first = re.search(r"^## .*?answers.*?$(.*?)^## ", read("README.md"), re.M | re.S | re.I)
    check(first, "README.md has no answers")
    for name, text in (("docs/results/README.md", results), ("README.md", first[1] if first else "")):
        ratios = [ratio for ratio in re.findall(r"(?<![\d.,])[0-2]\.\d\d(?![\d]| ?%)", text) if ratio != "0.50"]
        check(ratios, f"{name} has no ratios in its answers")
        for ratio in ratios:
            check(ratio in known, f"{name}: no line of {page} has the ratio {ratio}")
    return len(known)


count = [sum(map(check_links, PAGES)), sum(map(check_names, PAGES)), check_answers()]
for script in ("tools/package_parts",):
    for name in re.findall(r"\$repo/([\w./-]*\w)", read(script)):
        check(os.path.exists(name), f"{script} names {name}, which does not exist")
size = sum(os.path.getsize(path) for path in glob.glob("docs/results/**/*", recursive=True) if os.path.isfile(path))
check(size <= 6 << 20, f"docs/results has {size / (1 << 20):.1f} MiB, more than 6")
for path in glob.glob("docs/results/**/*.json", recursive=True):
    text = read(path)
    check(text.count("\n") <= 1 and '": ' not in text[:1000], f"{path} has white space")
print(*faults, sep="\n", end="\n" if faults else "")
print("{} links, {} names of files and {} ratios".format(*count))
sys.exit(1 if faults else 0)
