#!/usr/bin/env python3
"""Runs clang-tidy (rules: .clang-tidy) over sources and the project's headers that they include.

    scripts/lint.py [--jobs N] [--budget SECONDS] [--checks CHECKS] [--alone] [FILE.cpp...]

Without files: every source that git knows. The preset `lint` is configured for the compile commands; nothing is built.
Results are kept per source, under the hash of all that they depend on: the rules, the compile command, and the source
with every header of the project behind it. What has not changed since is not checked again. With a budget, no file is
begun after so many seconds, the files that were committed last come first, and what was left out is said. Exit code 1
if anything was found.

Most of the time goes into the headers of libraries, so sources with the same flags are read together: their texts stand
one behind the other in one file, and where that file is clean, all of them are. Where anything is found, or they do not
compile together, each is checked by itself, and that is what is printed. --alone does so from the beginning; it differs
in one thing: a using-declaration that only another source of the same file uses counts as used.
"""
import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "lint"
CACHE = pathlib.Path(os.environ.get("XDG_CACHE_HOME", pathlib.Path.home() / ".cache")) / "rayfield-lint"
INCLUDE = re.compile(rb'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)
KEPT_RESULTS = 5000
SOURCES_AT_ONCE = 10
# What a source declares at the left margin, where namespaces do not indent: types; functions and variables.
TYPE = re.compile(r"^(?:template <[^>]*> )?(?:struct|class|enum(?: class)?|union|#define|concept) +(\w+)|^using (\w+) = ", re.MULTILINE)
VALUE = re.compile(r"^(?!namespace|using)[A-Za-z][\w:<>,&* \[\]]*?[ &*](\w+)(?:\(|\{| = |;|\[|$)", re.MULTILINE)


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


def names_in(source):
    """The names that the source has to itself, and those that no other source beside it may have to itself."""
    def names(text):
        return {match.group(match.lastindex) for match in (*TYPE.finditer(text), *VALUE.finditer(text))}

    text = (ROOT / source).read_text()
    unnamed = re.findall(r"^namespace \{$(.*?)^\}  // namespace$", text, re.MULTILINE | re.DOTALL)
    return names("\n".join(unnamed)), names(text)


def flags_of(source, command):
    """The compile command without what names the source and its object file."""
    words = shlex.split(command)
    object_file = words.index("-o")
    return [word for at, word in enumerate(words) if at not in (object_file, object_file + 1) and
            word not in ("-c", source, str(ROOT / source))]


def in_batches(sources, commands):
    """The sources in groups that can be read as one file: equal flags and rules, no name in two unnamed namespaces."""
    batches, open_batches = [], {}
    for source in sources:
        own, all_names = names_in(source)
        group = (source.split("/")[0], *flags_of(source, commands[source]))
        for batch in open_batches.setdefault(group, []):
            if len(batch["sources"]) < SOURCES_AT_ONCE and not (own & batch["all"] or all_names & batch["own"]):
                break
        else:
            batch = {"sources": [], "own": set(), "all": set()}
            open_batches[group].append(batch)
            batches.append(batch["sources"])
        batch["sources"].append(source)
        batch["own"] |= own
        batch["all"] |= all_names
    return batches


def write_batch(sources):
    """One file with the texts of all. It lies where the rules of their folder hold."""
    folder = BUILD / "batches" / sources[0].split("/")[0]
    folder.mkdir(parents=True, exist_ok=True)
    rules = ROOT / folder.name / ".clang-tidy"
    if rules.exists():
        shutil.copyfile(rules, folder / ".clang-tidy")

    def from_here(source):
        def absolute(include):
            beside = ROOT / pathlib.Path(source).parent / include.group(2)
            return f'{include.group(1)}"{beside}"' if beside.is_file() else include.group(0)
        return absolute

    texts = (re.sub(r'^(\s*#\s*include\s+)"([^"]+)"', from_here(source), (ROOT / source).read_text(), flags=re.MULTILINE)
             for source in sources)
    batch = folder / (hashlib.sha256("\0".join(sources).encode()).hexdigest()[:16] + ".cpp")
    batch.write_text("\n".join(texts))
    return batch


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
    parser.add_argument("--alone", action="store_true", help="every source by itself")
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

    def key_of(source):
        command = commands[source].replace(str(ROOT), ".")
        return hashlib.sha256("\0".join([*rules, command, *dependencies.hashes(source)]).encode()).hexdigest()

    def run(source, *command):
        """What clang-tidy finds in the file: nothing where it is clean."""
        options = [f"--checks={arguments.checks}"] if arguments.checks else []
        done = subprocess.run([tidy, "--quiet", *options, *command], cwd=ROOT, capture_output=True, text=True)
        if done.returncode == 0:
            return ""
        return done.stdout.replace(str(ROOT) + "/", "") or f"{source}: clang-tidy failed: {done.stderr.strip()[-500:]}\n"

    def keep(source, finding):
        kept = CACHE / keys[source]
        temporary = kept.with_suffix(f".{os.getpid()}")
        temporary.write_text(finding)
        temporary.replace(kept)

    def check(batch):
        """{source: finding}: an empty finding where the source is clean; no source for which there was no time."""
        def in_time():
            return arguments.budget is None or time.monotonic() - begun <= arguments.budget

        if not in_time():
            return {}
        findings = {}
        if len(batch) > 1:
            file = write_batch(batch)
            if not run(file, str(file), "--", *flags_of(batch[0], commands[batch[0]])[1:]):
                findings = dict.fromkeys(batch, "")
            file.unlink()
        for source in batch:
            if source not in findings and in_time():
                findings[source] = run(source, "-p", str(BUILD), source)
        for source, finding in findings.items():
            keep(source, finding)
        return findings

    keys = {source: key_of(source) for source in wanted}
    findings = {}
    for source, key in keys.items():
        if (CACHE / key).exists():
            os.utime(CACHE / key)
            findings[source] = (CACHE / key).read_text()
    waiting = newest_first(source for source in wanted if source not in findings)
    batches = [[source] for source in waiting] if arguments.alone else in_batches(waiting, commands)
    printed = set()  # a finding in a header is reported for every source that includes it

    def show(found):
        for finding in found.values():
            for one in re.split(r"^(?=[^\s:]+:\d+:\d+: (?:error|warning): )", finding, flags=re.MULTILINE):
                if one and one not in printed:
                    printed.add(one)
                    print(one, end="", flush=True)

    show(findings)
    with concurrent.futures.ThreadPoolExecutor(max(1, arguments.jobs)) as pool:
        for found in pool.map(check, batches):
            show(found)
            findings |= found
    forget_old_results()
    bad, left = sum(map(bool, findings.values())), len(wanted) - len(findings)
    checked = len(waiting) - left
    print(f"lint: {len(findings) - bad} sources clean, {bad} with findings ({checked} checked now in "
          f"{time.monotonic() - begun:.0f} s, the others as before)", end="")
    print(f"; NOT CHECKED for lack of time: {left}" if left else "")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
