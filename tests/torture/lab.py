"""What all attacks share: the program, stores to attack, and what counts as a finding."""
import dataclasses
import hashlib
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

SITE = """[site]
name = "torture"
latitude_deg = 47.3
longitude_deg = 8.4
seed = 5
[terrain]
slope_percent = 3
[rows]
count = 2
length_m = 14
spacing_m = 2.5
azimuth_deg = 70
panel_length_m = 3.5
[canopy]
leaf_area_m2_per_m = 1.8
[surroundings]
trees = 1
buildings = 0
fence = false
[spinning]
beams = 71
[[date]]
date = "2021-03-01"
leaf_fraction = 0.0
seed = 1
[[date]]
date = "2021-07-01"
seed = 2
"""
CRS = "EPSG:32632"
DATES = ("2021-03-01", "2021-07-01")
DOCUMENTED = {0, 2, 3, 4, 5, 6, 130}  # docs/commands.md; 1 is an internal error
# Differ with the history, not with what a store holds; and a report with the time that its parts took.
OWN = ("snapshots/", "store.json", "lock", "trash/", "timed_")
TIMEOUT_S = 300


@dataclasses.dataclass
class Outcome:
    code: int  # as of a shell: 128 + signal
    out: str
    err: str

    def lines(self):
        return [line for line in self.err.splitlines() if line.startswith("rayfield: ")]


@dataclasses.dataclass
class Tally:
    """Of one kind of attack: how often it was made, and what it found."""
    runs: int = 0  # attacks that really happened: a signal to a running process, a system call that was made to fail
    lost: int = 0
    wrong: int = 0
    crashed: int = 0
    unclear: int = 0
    notes: list = dataclasses.field(default_factory=list)
    skipped: str = ""

    def find(self, kind, text):
        setattr(self, kind, getattr(self, kind) + 1)
        self.notes.append(f"{kind}: {text}")
        print(f"{kind}: {text}", file=sys.stderr, flush=True)

    def findings(self):
        return self.lost + self.wrong + self.crashed + self.unclear

    def judge(self, outcome, allowed, what):
        """Whether the program ended as it may: a documented code, and one line where it failed."""
        if outcome.code not in DOCUMENTED:
            self.find("crashed", f"{what}: exit {outcome.code}: {outcome.err[-300:]}")
        elif outcome.code not in allowed:
            self.find("wrong", f"{what}: exit {outcome.code}, not {sorted(allowed)}: {outcome.err[-300:]}")
        elif outcome.code not in (0, 130) and len(outcome.lines()) != 1:
            self.find("unclear", f"{what}: exit {outcome.code} with {len(outcome.lines())} lines: {outcome.err[-300:]}")
        else:
            return True
        return False


def content(folder):
    """{path: SHA-256} of all that a store, or a folder of products, holds."""
    found = {}
    for path in sorted(pathlib.Path(folder).rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and not path.is_symlink() and not name.startswith(OWN):
            found[name] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found


class Lab:
    """Simulated rays, and stores made of them that no attack touches: attacks work on copies."""

    def __init__(self, program, folder, seed):
        os.environ["SOURCE_DATE_EPOCH"] = "1614600000"  # so that nothing depends on when it was made
        self.program = str(pathlib.Path(program).resolve())
        self.damager = pathlib.Path(self.program).parent.parent / "tests" / "fault" / "store_damage"
        self.calm = {}  # what jobs make in peace, see jobs.py
        self.folder = pathlib.Path(folder).resolve()
        self.random = random.Random(seed)
        self.folder.mkdir(parents=True)
        site = self.folder / "site.toml"
        site.write_text(SITE)
        self.must("simulate", site, "-o", self.folder / "logs", "--no-log", "-q")
        self.clouds = {date: self.folder / "logs" / date / "rays.ply" for date in DATES}
        self.must("simulate", site, "-o", self.folder / "drives", "--no-rays", "--date", DATES[1], "-q")
        self.log = self.folder / "drives" / DATES[1]
        self.stores = {}
        store = self.folder / "calm" / "block"  # all stores have one name: products have it in theirs
        store.parent.mkdir()
        self.must("init", store, "--crs", CRS)
        self._keep("empty", store)
        self.must(*self.add(store, DATES[0]))
        self._keep("one", store)
        self.must(*self.add(store, DATES[1]))
        self._keep("two", store)
        self.seconds = {"add": 0.5}
        begun = time.monotonic()
        self.must("process", store, "-q")
        self.seconds["process"] = time.monotonic() - begun
        self.must("gc", store, "-q")
        self._keep("whole", store)
        self.must("registry", "export", store, "-o", self.folder / "reference.geojson", "-q")
        begun = time.monotonic()
        self.must("export", store, "-o", self.folder / "maps", "-q")
        self.seconds["export"] = time.monotonic() - begun
        self._litter(store)
        self._keep("littered", store)
        shutil.rmtree(store)
        shutil.copytree(self.stores["two"], store, symlinks=True)
        (store / "snapshots" / "00000002.json").unlink()
        self._keep("torn", store)

    def _litter(self, store):
        """What writers leave that were killed: temporary files, and derived files and tiles that no snapshot names."""
        (store / "tmp").mkdir(exist_ok=True)
        (store / "tmp" / ("0" * 32 + ".tmp")).write_bytes(b"half a file")
        for path in [*sorted((store / "scans" / DATES[0] / "ground").iterdir())[:3],
                     *sorted((store / "scans" / DATES[0] / "rays").iterdir())[:2]]:
            stem = path.name.rsplit(".", 2)[0]
            shutil.copy(path, path.with_name(f"{stem}.{'0123456789abcdef'}.h5"))

    def _keep(self, name, store):
        self.stores[name] = self.folder / "stores" / name / "block"
        shutil.copytree(store, self.stores[name], symlinks=True)

    @staticmethod
    def time_is_left(until):
        return time.monotonic() < until

    def add(self, store, date):
        return ("add", store, self.clouds[date], "--date", date, "-q")

    def copy(self, name, where="work"):
        """A fresh copy of a store."""
        folder = self.folder / where
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(self.stores[name], folder / "block", symlinks=True)
        return folder / "block"

    def run(self, *words, prefix=(), env=None, prepare=None):
        try:
            done = subprocess.run([*prefix, self.program, *map(str, words)], capture_output=True, text=True,
                                  errors="replace", timeout=TIMEOUT_S, env={**os.environ, **(env or {})},
                                  preexec_fn=prepare)
        except subprocess.TimeoutExpired:
            return Outcome(124, "", f"still running after {TIMEOUT_S} s")  # no documented code: it hangs
        return Outcome(done.returncode if done.returncode >= 0 else 128 - done.returncode, done.stdout, done.stderr)

    def must(self, *words):
        outcome = self.run(*words)
        if outcome.code != 0:
            raise SystemExit(f"torture: {' '.join(map(str, words))}: exit {outcome.code}: {outcome.err}")
        return outcome

    def run_and_signal(self, words, after_s, number=signal.SIGKILL):
        """Runs a command and sends a signal after that time. Outcome, code 137 after SIGKILL."""
        process = subprocess.Popen([self.program, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, errors="replace")
        try:
            out, err = process.communicate(timeout=after_s)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
            try:
                out, err = process.communicate(timeout=TIMEOUT_S)
            except subprocess.TimeoutExpired:
                process.kill()
                out, err = process.communicate()
                return Outcome(124, out, f"still running {TIMEOUT_S} s after signal {number}")
        code = process.returncode
        return Outcome(code if code >= 0 else 128 - code, out, err)

    def verify(self, store, tally, what):
        """A store that nobody damaged is whole, whatever happened to its writers."""
        verified = self.run("verify", store, "--all", "-q")
        if verified.code != 0:
            tally.find("lost", f"{what}: verify exits {verified.code}: {verified.err[-300:]}")
        return verified.code == 0

    def scans(self, store):
        status = self.run("status", store, "--json", "-q")
        return [scan["scan_id"] for scan in json.loads(status.out)["scans"]] if status.code == 0 else None

