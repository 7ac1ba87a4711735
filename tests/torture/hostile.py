"""Attacks by what is given to the program: each ends with a documented code and one line, and the store as it was."""
import os
import struct
import time

from lab import CRS, DATES, Tally, content

HEADER = ("ply\nformat binary_little_endian 1.0\ncomment crs {crs}\nelement vertex {count}\nproperty double x\n"
          "property double y\nproperty double z\nproperty double time\nproperty float nx\nproperty float ny\n"
          "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
          "end_header\n")
REFUSED = {2, 3, 5}


def cloud(rays, crs=CRS, count=None):
    """Bytes of a ray cloud; rays: (x, y, z, time, nx, ny, nz)."""
    body = b"".join(struct.pack("<4d3f4B", *ray, 90, 90, 90, 255) for ray in rays)
    return HEADER.format(crs=crs, count=len(rays) if count is None else count).encode() + body


def line_of_rays(x=0.0, y=0.0, z=0.0, start=1614600000.0, n=2000, end=(1.0, 1.0, -1.0)):
    return [(x + 0.001 * i, y, z, start + 0.001 * i, *end) for i in range(n)]


def clouds(good):
    """{name: bytes} of clouds that no vineyard gave."""
    bad = float("nan")
    return {
        "empty file": b"", "no cloud": b"<html>\n" * 200, "only a header": good[:good.index(b"end_header") + 11],
        "cut header": good[:60], "cut in a ray": good[:len(good) // 2 + 3], "too many rays claimed": cloud(line_of_rays(), count=10**15),
        "negative count": cloud(line_of_rays(), count=-5), "no rays": cloud([]),
        "not numbers": cloud(line_of_rays(x=bad)), "infinite": cloud(line_of_rays(x=float("inf"))),
        "far away": cloud(line_of_rays(x=1e300)), "at the pole of nowhere": cloud(line_of_rays(x=0.0, y=0.0)),
        "times of 1e300": cloud(line_of_rays(x=455000, y=5238000, start=1e300)),
        "times not numbers": cloud(line_of_rays(x=455000, y=5238000, start=bad)),
        "other crs": cloud(line_of_rays(x=455000, y=5238000), crs="EPSG:7854"),
        "crs nobody knows": cloud(line_of_rays(x=455000, y=5238000), crs="EPSG:999999"),
        "crs of control characters": cloud(line_of_rays(x=455000, y=5238000), crs="\x01\x02"),
        "local crs": cloud(line_of_rays(), crs="local"), "property of a kilobyte": b"ply\n" + b"comment " + b"a" * 10**6,
    }


def commands(lab, store, folder):
    """(what, words, allowed codes) besides clouds."""
    good, date = lab.clouds[DATES[1]], DATES[1]
    fifo, link = folder / "fifo", folder / "link"
    os.mkfifo(fifo)
    link.symlink_to("/nowhere/at/all")
    (folder / "file").write_text("a file")
    (folder / "bad.toml").write_text("[process\n")
    (folder / "unknown.toml").write_text("[process]\nnonsense = 3\n")
    add = ("add", store, good, "--date")
    yield from (("date " + repr(d), (*add, d), {2, 3}) for d in
                ("2019-02-30", "0000-01-01", "9999-12-31", "", "today", "2021-7-1", "2021-07-01T00:00", "-1", "٢٠٢١-٠٧-٠١"))
    yield from (("name " + repr(n), (*add, date, "--name", n), {2, 3}) for n in ("..", "\n", "a" * 5000, "-", " "))
    yield from (("name " + repr(n), (*add, date, "--name", n), {0, 2, 3}) for n in ("../x", "a/b"))  # a label, no path
    yield from (("input " + str(i), ("add", store, i, "--date", date), REFUSED) for i in
                (fifo, "/dev/zero", "/dev/null", link, folder, "/proc/self/mem", folder / "missing", ""))
    yield from (("crs " + repr(c), ("init", folder / "new", "--crs", c), {2, 3}) for c in
                ("", "EPSG:", "EPSG:4326", "EPSG:3857", "EPSG:2277", "EPSG:99999999", "utm", "'; DROP", "+proj=", "\x01"))
    yield from (("store " + str(s), ("status", s), {2, 3, 4, 5}) for s in
                (folder, folder / "file", folder / "missing", fifo, link, "/dev/null", "/proc", ""))
    yield from ((f"option {o}", ("process", store, *o), {2}) for o in
                (("--memory", "-1"), ("--memory", "1e99"), ("--memory", "x"), ("--threads", "0"), ("--set", "x"),
                 ("--set", "posts.min_contrast=nan"), ("--set", "posts.min_contrast=1e400"), ("--nonsense",),
                 ("--config", folder / "bad.toml"), ("--config", folder / "unknown.toml"), ("--date", "2031-01-01")))
    yield from ((f"output {o}", ("export", store, "-o", o), REFUSED | {4}) for o in
                (folder / "file", "/proc/maps", "/dev/null", "/sys/maps"))
    yield "rig that is none", ("add", store, good, "--date", date, "--rig", folder / "file"), {2, 3}
    yield "same scan twice", ("add", store, lab.clouds[DATES[0]], "--date", DATES[0]), {0, 2, 3}
    yield "a verb that is none", ("proces", store), {2}
    yield "report over a file that is none", ("report", store, "-o", folder / "file"), {2, 3}
    yield "remove what is not there", ("remove", store, "2031-01-01"), {2, 3}
    yield "revert to what is not there", ("revert", store, "999"), {2, 3, 4}


def inputs(lab, until):
    """Everything once; it does not depend on the time that is left."""
    del until
    tally = Tally()
    folder = lab.folder / "hostile"
    folder.mkdir()
    store = lab.copy("one")
    before = content(store)
    good = lab.clouds[DATES[1]].read_bytes()
    cases = []
    for what, data in clouds(good).items():
        path = folder / (what.replace(" ", "_") + ".ply")
        path.write_bytes(data)
        cases.append((f"cloud: {what}", ("add", store, path, "--date", DATES[1], "--no-align"), REFUSED))
    for what, words, allowed in [*cases, *commands(lab, store, folder)]:
        begun = time.monotonic()
        outcome = lab.run(*words)
        tally.judge(outcome, allowed, what)
        if time.monotonic() - begun > 30:
            tally.find("unclear", f"{what}: takes {time.monotonic() - begun:.0f} s")
        after = content(store)
        if after != before and outcome.code != 0:
            tally.find("wrong", f"{what}: the store has changed")
        before = after
        if [path.name for path in store.parent.iterdir()] != [store.name]:
            tally.find("wrong", f"{what}: something was made outside of the store")
    lab.verify(store, tally, "after hostile inputs")
    return tally
