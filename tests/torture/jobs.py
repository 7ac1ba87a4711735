"""What the program is attacked at: one job for each verb, with what it makes when it is left in peace."""
import dataclasses
import shutil
import time

from lab import CRS, DATES, content


@dataclasses.dataclass(frozen=True)
class Job:
    """`before`: the store that it begins with, in Lab.stores; none: it makes what it works on."""
    name: str
    before: str
    words: object  # (lab, store, folder for products) -> words
    again: object = None  # the words after a failure, where other ones
    verifies: bool = True  # whether the store that it begins with is whole
    tidy: bool = False  # whether what was left has to be cleared before contents are compared
    seconds: float = 0.5  # about, until it is known

    def line(self, lab, store, products):
        return self.words(lab, store, products)

    def line_again(self, lab, store, products):
        return (self.again or self.words)(lab, store, products)


def _update(lab, store, out):
    return ("update", store, lab.clouds[DATES[1]], "--date", DATES[1], "-o", out / "maps", "-q")


def _slam(lab, _, out):
    return ("slam", lab.log / "scan.bag", "--rig", lab.log / "rig.toml", "--crs", CRS, "-o", out / "cloud.ply",
            "--trajectory", out / "trajectory.tum", "--report", out / "timed_report.json",
            "--picture", out / "plan.png", "-q")


def _simulate(lab, _, out):
    return ("simulate", lab.folder / "site.toml", "-o", out / "logs", "--date", DATES[1], "-q")


JOBS = {job.name: job for job in (
    Job("init", "", lambda lab, store, out: ("init", store, "--crs", CRS, "-q"), tidy=True),
    Job("init --reference", "", lambda lab, store, out:
        ("init", store, "--crs", CRS, "--reference", lab.folder / "reference.geojson", "-q"),
        tidy=True),
    Job("add", "one", lambda lab, store, out: lab.add(store, DATES[1]), tidy=True),
    Job("process", "two", lambda lab, store, out: ("process", store, "-q"), tidy=True, seconds=2),
    Job("update", "one", _update, tidy=True, seconds=4),
    Job("export", "whole", lambda lab, store, out: ("export", store, "-o", out / "maps", "-q")),
    Job("export of all formats", "whole", lambda lab, store, out:
        ("export", store, "-o", out / "maps", "--format", "svg,ply,las,shp,kml,geojson,flatgeobuf,csv,geotiff-plain",
         "-q")),
    Job("report", "whole", lambda lab, store, out: ("report", store, "-o", out / "report.html", "-q")),
    Job("compare", "whole", lambda lab, store, out: ("compare", store, *DATES, "-o", out / "changes", "-q")),
    Job("zones", "whole", lambda lab, store, out: ("zones", store, "-o", out / "zones", "-q")),
    Job("registry export", "whole", lambda lab, store, out:
        ("registry", "export", store, "-o", out / "rows.geojson", "-q"), again=lambda lab, store, out:
        ("registry", "export", store, "-o", out / "rows.geojson", "-q", "--overwrite")),
    Job("registry rename", "whole", lambda lab, store, out:
        ("registry", "rename", store, "--block", "hill", "--row", "1=Row 7", "-q"), tidy=True),
    Job("gc", "littered", lambda lab, store, out: ("gc", store, "-q")),
    Job("remove", "whole", lambda lab, store, out: ("remove", store, DATES[1], "-q"), tidy=True),
    Job("revert", "whole", lambda lab, store, out: ("revert", store, "2", "-q"), tidy=True),
    Job("repair", "torn", lambda lab, store, out: ("repair", store, "-q"), verifies=False, tidy=True),
    Job("verify", "whole", lambda lab, store, out: ("verify", store, "--all", "-q")),
    Job("status", "whole", lambda lab, store, out: ("status", store)),
    Job("info", "whole", lambda lab, store, out: ("info", lab.clouds[DATES[1]], "-q")),
    Job("simulate", "", _simulate, again=lambda *a: (*_simulate(*a), "--overwrite")),
    Job("slam", "", _slam, again=lambda *a: (*_slam(*a), "--overwrite"), seconds=10),
)}
WRITERS = ("add", "process", "update", "gc", "repair", "remove", "revert", "registry rename", "init", "export")


@dataclasses.dataclass
class Calm:
    """What a job makes in peace, and how long it takes."""
    seconds: float
    store: dict
    products: dict
    scans: object


def folders(lab, job, where="work"):
    """A fresh store for a job, and a folder for its products."""
    root = lab.folder / where
    shutil.rmtree(root, ignore_errors=True)
    (root / "out").mkdir(parents=True)
    store = lab.copy(job.before, where + "/store") if job.before else root / "store" / "block"
    store.parent.mkdir(exist_ok=True)
    return store, root / "out"


def calm(lab, job):
    """Made once."""
    if job.name not in lab.calm:
        store, products = folders(lab, job, "calm_job")
        begun = time.monotonic()
        lab.must(*job.line(lab, store, products))
        seconds = time.monotonic() - begun
        if job.tidy:
            lab.must("gc", store, "-q")
        lab.calm[job.name] = Calm(seconds, content(store), content(products), lab.scans(store))
    return lab.calm[job.name]


def ends_well(lab, job, store, products, tally, what, done):
    """After a failure the same command ends with what it makes in peace; where it was `done`, it has done so."""
    if not done:
        again = lab.run(*job.line_again(lab, store, products))
        if again.code != 0:
            tally.find("wrong", f"{what}, run again: exit {again.code}: {again.err[-300:]}")
            return
    if job.tidy:
        lab.run("gc", store, "-q")
    expected = calm(lab, job)
    for found, wanted, which in ((content(store), expected.store, "store"),
                                 (content(products), expected.products, "products")):
        differ = sorted(set(wanted.items()) ^ set(found.items()))
        if differ:
            tally.find("wrong", f"{what}{', said to be done' if done else ''}: other {which}, e.g. {differ[0][0]}")
    if store.exists() and lab.scans(store) != expected.scans:
        tally.find("lost", f"{what}: other scans")
