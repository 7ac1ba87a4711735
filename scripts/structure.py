#!/usr/bin/env python3
"""Prints the structure of the libraries as docs/architecture.md shows it: per library its folders of sources, the largest of
them, its public headers, its units (a header with the source of its name), and the longest chain of includes among them.

    scripts/structure.py [CHECKOUT]
"""
import collections
import os
import re
import sys

ROOT = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
LIBRARIES = ["core", "libtile", "libdensity", "formats", "libslam", "libalign", "sim", "experiments", "cli"]
INCLUDE = re.compile(r'^#include "([^"]+)"', re.M)


def sources(library):
    for folder, _, names in os.walk(os.path.join(ROOT, library)):
        for name in sorted(names):
            if name.endswith((".h", ".cpp")):
                yield os.path.relpath(os.path.join(folder, name), ROOT)


def stem(path):
    return os.path.splitext(os.path.basename(path))[0]


def longest_chain(uses):
    """Units on the longest chain. A source may use a helper whose header uses the source's own: such a pair is one step."""
    length = {}

    def chain(unit, path):
        if unit not in length:
            others = [other for other in sorted(uses[unit]) if other != unit and other not in path]
            length[unit] = 1 + max((chain(other, path + (unit,)) for other in others), default=0)
        return length[unit]

    return max((chain(unit, ()) for unit in sorted(uses)), default=0)


def describe(library):
    files = list(sources(library))
    units = {stem(path) for path in files}
    folders = collections.Counter(os.path.dirname(path) for path in files if "/include/" not in path)
    public = [path for path in files if "/include/" in path]
    uses = collections.defaultdict(set)
    headers = {stem(path) for path in files if path.endswith(".h")}
    sources_alone = {stem(path) for path in files if path.endswith(".cpp")} - headers
    for path in files:
        with open(os.path.join(ROOT, path), encoding="utf-8") as file:
            included = {stem(name) for name in INCLUDE.findall(file.read())
                        if not name.startswith("rayfield/") or name.split("/")[1] == library.removeprefix("lib")}
        uses[stem(path)] |= (included & units) - {stem(path)}
    largest, count = folders.most_common(1)[0]
    return [library, str(len(folders)), f"{os.path.relpath(largest, library)} ({count})", str(len(public)),
            str(len(units)), str(longest_chain(uses)), str(len(sources_alone))]


rows = [["library", "folders", "largest folder (files)", "public headers", "units", "longest chain of includes",
         "sources without a header of their name"], ["---"] * 7]
rows += [describe(library) for library in LIBRARIES]
for row in rows:
    print("| " + " | ".join(row) + " |")
