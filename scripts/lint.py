#!/usr/bin/env python3
"""Runs clang-tidy (rules: .clang-tidy) over sources and the project's headers that they include.

    scripts/lint.py [--jobs N] [--budget SECONDS] [--checks CHECKS] [FILE.cpp...]

Without files: every source that git knows. The preset `lint` is configured for the compile commands; nothing is built.
Results are kept per source, under the hash of all that they depend on: the rules, the compile command, and the source
with every header of the project behind it. What has not changed since is not checked again. With a budget, no file is
begun after so many seconds, the files that were committed last come first, and what was left out is said. Exit code 1
if anything was found.
"""
import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "lint"
CACHE = pathlib.Path(os.environ.get("XDG_CACHE_HOME", pathlib.Path.home() / ".cache")) / "rayfield-lint"
INCLUDE = re.compile(rb'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)
KEPT_RESULTS = 5000


def output_of(*command):
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout


def compile_commands():
    """Configures and returns {source: command}, paths relative to the root."""
    done = subprocess.run(["cmake", "--preset", "lint"], cwd=ROOT, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"lint: cmake --preset lint failed:\n{done.stderr}")
    with open(BUILD / "compile_commands.json", encoding="utf-8") as file:
        return {os.path.relpath(entry["file"], ROOT): entry["command"] for entry in json.load(file)}


class Dependencies:
    """The files of the project that a source includes, directly or not."""

    def __init__(self):
        self._folders = [ROOT, *sorted(ROOT.glob("*/include")), BUILD / "cli" / "generated"]
        self._known = {}  # path → (hash of its bytes, the paths that it includes)

    def _read(self, path):
        if path not in self._known:
            data = path.read_bytes()
            found = []
            for name in INCLUDE.findall(data):
                headers = (folder / name.decode() for folder in [path.parent, *self._folders])
                found += [header for header in headers if header.is_file()][:1]
            self._known[path] = (hashlib.sha256(data).hexdigest(), found)
        return self._known[path]

    def hashes(self, source):
        seen, waiting = {}, [ROOT / source]
        while waiting:
            path = waiting.pop()
            key = os.path.relpath(path, ROOT)
            if key not in seen:
                seen[key], includes = self._read(path)
                waiting.extend(includes)
        return [f"{path} {digest}" for path, digest in sorted(seen.items())]


def newest_first(sources):
    """The sources in the order of their last commits; tests behind others of the same age."""
    rank, commits = {}, 0
    for line in output_of("git", "log", "--format=tformat:commit", "--name-only", "-n", "200").split("\n"):
        commits += line == "commit"
        rank.setdefault(line, commits)
    return sorted(sources, key=lambda source: (rank.get(source, commits + 1), source.startswith("tests/"), source))


def forget_old_results():
    results = sorted(CACHE.iterdir(), key=lambda path: path.stat().st_mtime, reverse=True)
    for path in results[KEPT_RESULTS:]:
        path.unlink(missing_ok=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("files", nargs="*", metavar="FILE.cpp")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--budget", type=float, metavar="SECONDS")
    parser.add_argument("--checks", help="instead of those of .clang-tidy, e.g. -*,readability-identifier-naming")
    arguments = parser.parse_args()

    tidy = shutil.which("clang-tidy-14") or shutil.which("clang-tidy")
    if tidy is None:
        sys.exit("lint: clang-tidy is not installed: scripts/setup.sh check")
    commands = compile_commands()
    wanted = [os.path.relpath(name, ROOT) for name in arguments.files]
    if not wanted:
        wanted = output_of("git", "ls-files", "*.cpp").split()
        # A project of its own, built against an installed rayfield.
        wanted = [source for source in wanted if not source.startswith("tests/consumer/")]
    strangers = [source for source in wanted if source not in commands]
    if strangers:
        sys.exit(f"lint: in no target of the preset lint: {' '.join(strangers)}")

    CACHE.mkdir(parents=True, exist_ok=True)
    # The rules without their comments, and those of folders that differ.
    rules = [output_of(tidy, "--version"), arguments.checks or "", output_of(tidy, "--dump-config"),
             *(path.read_text() for path in sorted(ROOT.glob("*/.clang-tidy")))]
    dependencies = Dependencies()
    begun = time.monotonic()

    def check(source):
        """(finding, seconds): an empty finding where the source is clean, None where there was no time for it."""
        command = commands[source].replace(str(ROOT), ".")
        key = hashlib.sha256("\0".join([*rules, command, *dependencies.hashes(source)]).encode()).hexdigest()
        kept = CACHE / key
        if kept.exists():
            os.utime(kept)
            return kept.read_text(), 0.0
        started = time.monotonic()
        if arguments.budget is not None and started - begun > arguments.budget:
            return None, 0.0
        options = [f"--checks={arguments.checks}"] if arguments.checks else []
        done = subprocess.run([tidy, "-p", str(BUILD), "--quiet", *options, source], cwd=ROOT,
                              capture_output=True, text=True)
        finding = done.stdout.replace(str(ROOT) + "/", "")
        if done.returncode != 0 and not finding.strip():
            finding = f"{source}: clang-tidy failed: {done.stderr.strip()[-500:]}\n"
        if done.returncode == 0:
            finding = ""
        temporary = kept.with_suffix(f".{os.getpid()}.{source.replace('/', '_')}")
        temporary.write_text(finding)
        temporary.replace(kept)
        return finding, time.monotonic() - started

    counts = {"clean": 0, "found": 0, "checked": 0, "left": 0}
    printed = set()  # a finding in a header is reported for every source that includes it
    sources = newest_first(wanted)
    with concurrent.futures.ThreadPoolExecutor(max(1, arguments.jobs)) as pool:
        for finding, seconds in pool.map(check, sources):
            if finding is None:
                counts["left"] += 1
                continue
            counts["checked"] += seconds > 0
            counts["found" if finding else "clean"] += 1
            for one in re.split(r"^(?=[^\s:]+:\d+:\d+: (?:error|warning): )", finding, flags=re.MULTILINE):
                if one and one not in printed:
                    printed.add(one)
                    print(one, end="", flush=True)
    forget_old_results()
    print(f"lint: {counts['clean']} sources clean, {counts['found']} with findings ({counts['checked']} checked now in "
          f"{time.monotonic() - begun:.0f} s, the others as before)", end="")
    print(f"; NOT CHECKED for lack of time: {counts['left']}" if counts["left"] else "")
    return 1 if counts["found"] else 0


if __name__ == "__main__":
    sys.exit(main())
