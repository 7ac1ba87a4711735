"""Attacks by what is given to the program: each ends with a documented code and one line, and the store as it was."""
import hashlib
import json
import os
import time

import hostile_files as files
from lab import CRS, DATES, Tally, content

REFUSED = {2, 3, 5}
SLOW_S = 30


def written(path, data):
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return path


def clouds(lab, store, folder):
    good = lab.clouds[DATES[1]].read_bytes()
    for what, data in files.clouds(good).items():
        path = written(folder / (what.replace(" ", "_") + ".ply"), data)
        yield f"cloud: {what}", ("add", store, path, "--date", DATES[1], "--no-align"), REFUSED


def las_clouds(lab, store, folder):
    """LAS clouds with a sound path, a sound LAS cloud with other paths, and what does not go together."""
    del lab
    path, cloud = written(folder / "path.tum", files.las_path()), written(folder / "sound.las", files.las())
    date = ("--date", "2021-07-01", "--no-align", "--name", "las")
    for what, data in files.las_clouds().items():
        bad = written(folder / (what.replace(" ", "_") + ".las"), data)
        yield f"cloud: {what}", ("add", store, bad, "--trajectory", path, *date), REFUSED
        yield f"info of {what}", ("info", bad), {0, 3}
    for what, data in files.LAS_PATHS.items():
        given = () if data is None else ("--trajectory", written(folder / ("path_" + what.replace(" ", "_")), data))
        yield f"path of a LAS cloud: {what}", ("add", store, cloud, *given, *date), REFUSED
    ply = written(folder / "with_path.ply", files.cloud(files.line_of_rays()))
    yield "path of a PLY cloud", ("add", store, ply, "--trajectory", path, *date), {2}
    yield "path that is the cloud", ("add", store, cloud, "--trajectory", cloud, *date), REFUSED


def arguments(lab, store, folder):
    good, date = lab.clouds[DATES[1]], DATES[1]
    fifo, link = folder / "fifo", folder / "link"
    os.mkfifo(fifo)
    link.symlink_to("/nowhere/at/all")
    (folder / "file").write_text("a file")
    (folder / "bad.toml").write_text("[process\n")
    (folder / "unknown.toml").write_text("[process]\nnonsense = 3\n")
    add = ("add", store, good, "--date")
    yield from (("date " + repr(d), (*add, d), {2, 3}) for d in
                ("2019-02-30", "0000-01-01", "9999-12-31", "", "today", "2021-7-1", "2021-07-01T00:00", "-1", "٢٠٢١-٠٧-٠١",
                 "2021-07-01 ", "2021-13-01", "../2021-07-01", "1e3-01-01"))
    yield from (("name " + repr(n), (*add, date, "--name", n), {2, 3}) for n in ("..", "\n", "a" * 5000, "-", " "))
    yield from (("name " + repr(n), (*add, date, "--name", n), {0, 2, 3}) for n in ("../x", "a/b"))  # a label, no path
    yield from (("input " + str(i), ("add", store, i, "--date", date), REFUSED) for i in
                (fifo, "/dev/zero", "/dev/null", link, folder, "/proc/self/mem", folder / "missing", "", "a" * 5000))
    yield from (("crs " + repr(c), ("init", folder / "new", "--crs", c), {2, 3}) for c in
                ("", "EPSG:", "EPSG:4326", "EPSG:3857", "EPSG:2277", "EPSG:99999999", "utm", "'; DROP", "+proj=", "\x01",
                 "EPSG:4978", "EPSG:5703", "PROJCS[", "{}", "+proj=pipeline", "a" * 5000, "local"))
    yield from (("tile size " + s, ("init", folder / "new", "--crs", CRS, "--tile-size", s), {2}) for s in
                ("0", "-1", "nan", "inf", "1e300", "1e-9", "x"))
    yield from (("store " + str(s), ("status", s), {2, 3, 4, 5}) for s in
                (folder, folder / "file", folder / "missing", fifo, link, "/dev/null", "/proc", ""))
    yield from ((f"option {o}", ("process", store, *o), {2}) for o in
                (("--memory", "-1"), ("--memory", "1e99"), ("--memory", "x"), ("--threads", "0"), ("--threads", "1e9"),
                 ("--set", "x"), ("--set", "=1"), ("--set", "posts.min_contrast=[1,2]"), ("--set", "nonsense=1"),
                 ("--set", "posts.min_contrast=nan"), ("--set", "posts.min_contrast=1e400"), ("--nonsense",),
                 ("--config", folder / "bad.toml"), ("--config", folder / "unknown.toml"), ("--date", "2031-01-01")))
    yield from ((f"output {o}", ("export", store, "-o", o), REFUSED | {4}) for o in
                (folder / "file", "/proc/maps", "/dev/null", "/sys/maps"))
    yield "rig that is none", ("add", store, good, "--date", date, "--rig", folder / "file"), {2, 3}
    yield "same scan twice", ("add", store, lab.clouds[DATES[0]], "--date", DATES[0]), {0, 2, 3}
    yield "a verb that is none", ("proces", store), {2}
    yield "no verb", (), {0, 2}
    yield "report over a file that is none", ("report", store, "-o", folder / "file"), {2, 3}
    yield "remove what is not there", ("remove", store, "2031-01-01"), {2, 3}
    yield from ((f"revert to {n}", ("revert", store, n), {2, 3, 4}) for n in
                ("999", "-1", "x", "1e9", "18446744073709551616"))


def settings(lab, store, _):
    """Options of the algorithms with a value that makes no sense for any."""
    listed = json.loads(lab.must("options", "--json").out)
    words = {"process": ("process", store), "zones": ("zones", store, "-o", "/nowhere"), "compare": ("compare", store),
             "report": ("report", store, "-o", "/nowhere/r.html"),
             "add": ("add", store, lab.clouds[DATES[1]], "--date", DATES[1]),
             "slam": ("slam", lab.log / "scan.bag", "--rig", lab.log / "rig.toml", "-o", "/nowhere/x.ply")}
    for verb, options in listed.items():
        for option in options[::4]:
            yield f"{verb} --set {option['key']}=nan", (*words[verb], "--set", f"{option['key']}=nan"), {2}


def texts(lab, store, folder):
    """Rig files, sites, configurations, lists of blocks."""
    rig, site = (lab.log / "rig.toml").read_text(), (lab.folder / "site.toml").read_text()
    config = "threads = 2\n[process]\npanel-length = 7.5\n[process.posts]\nmin_contrast = 2.5\n"
    batch = f'[[block]]\nstore = "{store}"\ninputs = ["{lab.clouds[DATES[1]]}"]\ndate = {DATES[1]}\nset = []\n'
    slam = ("slam", lab.log / "scan.bag", "-o", folder / "x.ply", "--rig")
    lists = {f"list of blocks with {old!r} as {new!r}": batch.replace(old, new) for old, new in (
        (f"date = {DATES[1]}", "date = 2021-02-30"), (f"date = {DATES[1]}", "date = 5"), ("set = []", "set = [5]"),
        ("inputs", "inputt"), ('inputs = ["', 'inputs = [["'), ("[[block]]", "[block]"), ("store =", "store = 5 #"),
        ("set = []", 'set = ["x"]'), ("set = []", 'rig = "missing.toml"'), ("set = []", 'crs = "utm"'))}
    configs = {f"configuration of {value}": config.replace("panel-length = 7.5", value) for value in (
        'panel-length = "x"', "panel-length = -1", "panel-length = nan", "panel-length = [1, 2]", "panel-length = {}",
        "overwrite = 5", "config = \"x\"", "help = true", "posts = 5", "date = 2021-01-01")}
    rigs = {**files.tomls(rig, "rig"), **files.changed_values(rig, files.RIG_VALUES)}
    sites = {**files.tomls(site, "site"), **files.changed_values(site, files.SITE_VALUES)}
    for texts_of_kind, words, allowed in (
            (rigs, slam, {2, 3}), (sites, ("simulate", "-o", folder / "logs", "--no-log"), {2, 3, 5}),
            ({**files.tomls(config, "configuration"), **configs},
             ("process", store, "--date", "2031-01-01", "--config"), {2, 3}),
            ({**files.tomls(batch, "list of blocks"), **lists}, ("update", "-q", "--batch"), {2, 3})):
        for what, data in texts_of_kind.items():
            path = written(folder / f"{hashlib.sha256(what.encode()).hexdigest()[:16]}.toml", data)
            yield what, (words[0], path, *words[1:]) if words[0] == "simulate" else (*words, path), allowed


def layers(lab, store, folder):
    """References, rates, logs and trajectories. The store has no results that zones could be made of: `whole` has."""
    slam = ("--rig", lab.log / "rig.toml", "-o", folder / "x.ply", "--overwrite")
    for name, data in files.references((lab.folder / "reference.geojson").read_text()).items():
        path = written(folder / name, data)
        yield f"reference {name}", ("init", folder / "surveyed", "--crs", CRS, "--reference", path), {2, 3}
        yield f"registry import {name}", ("registry", "import", store, path), {2, 3}
    whole = lab.copy("whole", "zoned")
    for what, data in files.RATES.items():
        path = written(folder / (what.replace(" ", "_") + ".csv"), data)
        yield f"rates {what}", ("zones", whole, "-o", folder / "zones", "--product", "water", "--rate-unit", "l/ha",
                                "--rates", path), {2, 3}
    for what, data in files.logs((lab.log / "scan.bag").read_bytes()).items():
        path = written(folder / (what.replace(" ", "_") + ".bag"), data)
        allowed = {0, 3} if what == "cut in a chunk" else {3}  # of what is whole before the cut a cloud may be made
        yield f"log {what}", ("slam", path, *slam), allowed
        yield f"info of log {what}", ("info", path), {0, 3}
    good = next((lab.log / "truth").glob("trajectory*")).read_text()
    for what, data in files.trajectories(good).items():
        path = written(folder / (what.replace(" ", "_") + ".tum"), data)
        yield f"trajectory {what}", ("slam", lab.log / "scan.bag", *slam, "--use-trajectory", path), {2, 3}


def inputs(lab, until):
    """Everything once; it does not depend on the time that is left."""
    del until
    tally = Tally()
    folder = lab.folder / "hostile"
    folder.mkdir()
    store = lab.copy("one")
    before = content(store)
    for cases in (clouds, las_clouds, arguments, settings, texts, layers):
        for what, words, allowed in cases(lab, store, folder):
            begun = time.monotonic()
            outcome = lab.run(*words)
            tally.runs += 1
            tally.judge(outcome, allowed, what)
            if time.monotonic() - begun > SLOW_S:
                tally.find("unclear", f"{what}: takes {time.monotonic() - begun:.0f} s")
            after = content(store)
            if after != before and outcome.code != 0:
                tally.find("wrong", f"{what}: the store has changed")
            before = after
            if [path.name for path in store.parent.iterdir()] != [store.name]:
                tally.find("wrong", f"{what}: something was made outside of the store")
    lab.verify(store, tally, "after hostile inputs")
    return tally
