#!/usr/bin/env python3
"""Drives a report in headless Chromium as a reader would: date slider, click on the map, keys, tables, dark, 390 px
wide, print. Nothing may complain, ask for anything from outside, or run what a block's name says.

    tests/cli/report_browser/report_browser.py PROGRAM WORK_FOLDER [--report FILE] [--pictures FOLDER]

Without --report a small site is simulated, mapped and given hostile names. Ends with 77 where there is no Chromium, or
where it does not start.
"""
import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from chromium import Chromium, find_chromium  # noqa: E402

HOSTILE = {"--block": "<img src=x onerror=window.hacked=1>",
           "--farm": "Hill & \"Dale\" </script><script>window.hacked=2</script>", "--variety": "Shiraz {{data}}"}
SITE = """[site]
name = "small"
latitude_deg = -35.2
longitude_deg = 138.5
seed = 5
[rows]
count = 3
length_m = 14
spacing_m = 2.5
azimuth_deg = 70
panel_length_m = 3.5
[canopy]
leaf_area_m2_per_m = 1.8
vigour_variation = 0.4
[spinning]
beams = 143
""" + "".join(f'[[date]]\ndate = "{date}"\nleaf_fraction = {leaves}\nseed = {seed}\n'
              for date, leaves, seed in (("2020-08-01", 0.0, 1), ("2020-11-20", 0.5, 2), ("2021-02-10", 1.0, 3)))

failures = []


def check(truth, what):
    print(("ok    " if truth else "FAILED ") + what)
    if not truth:
        failures.append(what)


def make_report(program, work):
    def rayfield(*arguments):
        subprocess.run([program, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)

    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    (work / "site.toml").write_text(SITE)
    rayfield("simulate", work / "site.toml", "-o", work / "logs", "--no-log", "-q")
    rayfield("init", work / "block", "--crs", "EPSG:7854")
    for folder in sorted((work / "logs").iterdir()):
        rayfield("add", work / "block", folder / "rays.ply", "--date", folder.name, "-q")
    rayfield("process", work / "block", "-q")
    rayfield("registry", "rename", work / "block", *[word for pair in HOSTILE.items() for word in pair])
    rayfield("report", work / "block", "-o", work / "report.html", "-q")
    return work / "report.html"


# Pixels of the map's canvas that are not transparent, and a fingerprint of all.
MAP = """(() => { const c = document.querySelector('#map canvas'), copy = document.createElement('canvas');
  [copy.width, copy.height] = [c.width, c.height]; const context = copy.getContext('2d', { willReadFrequently: true });
  context.drawImage(c, 0, 0); const d = context.getImageData(0, 0, c.width, c.height).data;
  let seen = 0, sum = 0;
  for (let i = 0; i < d.length; i += 4) {
    if (d[i + 3]) ++seen;
    sum = (31 * sum + d[i] + 7 * d[i + 1] + 13 * d[i + 2] + d[i + 3]) % 1000003;
  }
  return [seen, sum]; })()"""
SETTLED = "[...document.querySelectorAll('#map canvas, .side canvas, .thumbs canvas')].every((c) => c.width > 1)"
# Relative luminances after WCAG 2, and from them the contrast of two colours given as CSS variables.
CONTRAST = """((a, b) => { const probe = document.createElement('i'); document.body.append(probe);
  const light = (name) => {
    probe.style.color = `var(${name})`;
    const parts = getComputedStyle(probe).color.match(/[\\d.]+/g).slice(0, 3);
    const [r, g, b] = parts.map((v) => v / 255).map((v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const [x, y] = [light(a), light(b)].sort((p, q) => q - p); probe.remove(); return (x + 0.05) / (y + 0.05); })"""


def panel_centre(page, index):
    """Where a panel's middle is on the screen."""
    return page.js("(() => { map.root.scrollIntoView({block: 'center'});"
                   f" const b = map.polygons[{index}].getBoundingClientRect();"
                   " return [b.left + b.width / 2, b.top + b.height / 2]; })()")


def check_text(page):
    heading = page.js("document.querySelector('h1').textContent")
    check(heading == "Block " + HOSTILE["--block"], "the block's name is shown as it is: " + heading)
    check(HOSTILE["--farm"] in page.js("document.querySelector('.sub').textContent"), "so is the farm's")
    check("{{data}}" in page.js("document.querySelector('.sub').textContent"), "and what looks like a template")
    check(page.js("document.images.length === 0 && document.scripts.length === 2"), "no element came of a name")
    check(page.js("window.hacked === undefined"), "no script ran that came from a name")
    inline = page.js("[...document.querySelectorAll('*')].flatMap((e) => [...e.attributes])"
                     ".filter((a) => a.name.startsWith('on')).length")
    check(inline == 0, "there are no inline handlers")


def check_dates(page):
    last = page.js("data.scans.length - 1")
    page.js("document.getElementById('date').focus()")
    before, text = page.js(MAP), page.js("document.getElementById('date-text').textContent")
    check(before[0] > 1000, f"the map is drawn: {before[0]} pixels")
    page.press("ArrowLeft", 37)
    page.wait_for(f"chosen.date === {last - 1}")
    page.wait_for(f"JSON.stringify({MAP}) !== '{json.dumps(before, separators=(',', ':'))}'")
    check(page.js("document.getElementById('date-text').textContent") != text, "keys on the slider change date and map")
    check(page.js("document.getElementById('date').getAttribute('aria-valuetext')") ==
          page.js(f"data.scans[{last - 1}].label"), "and it says the date to those who cannot see it")
    page.js("document.getElementById('date-on').click()")
    page.wait_for(f"JSON.stringify({MAP}) === '{json.dumps(before, separators=(',', ':'))}'")
    check(True, "and back to the same picture")


def check_panels(page):
    wanted = page.js("panels.findIndex((p) => p.index !== chosen.panel && p.row === panels[chosen.panel].row)")
    page.click(*panel_centre(page, wanted))
    name = page.js(f"panelName(panels[{wanted}])")
    page.wait_for(f"document.getElementById('panel-h').textContent === {json.dumps(name)}", 10)
    check(True, f"a click shows {name}")
    points, seen = (page.js("document.querySelectorAll('#panel-curve circle.dot').length"),
                    page.js("data.scans.filter((s, d) => valueOf(panels[chosen.panel], d)).length"))
    check(points == seen, "with a point for each date that saw it")
    sides = page.js("document.querySelectorAll('#panel-sides canvas').length")
    check(sides == page.js("data.scans.length"), "and its side view on all dates")
    canopy = page.js("document.querySelectorAll('#canopy-table tbody tr').length")
    check(canopy == page.js("data.scans.length"), "and what its canopy is like on all dates")
    page.js("map.root.focus()")
    page.press("ArrowDown" if page.js("panels[chosen.panel].rowIndex === 0") else "ArrowUp", 40)
    page.wait_for(f"panels[chosen.panel].rowIndex !== panels[{wanted}].rowIndex", 10)
    check(True, "arrow keys on the map go to the next row")
    page.js("document.getElementById('all-panels').open = true")
    page.wait_for("document.querySelectorAll('#panels-table tbody tr').length === panels.length", 10)
    check(True, "the table holds every panel")
    page.js("document.getElementById('all-panels').open = false")


def choose(page, name, value):
    page.js(f"(() => {{ const s = document.getElementById('{name}'); s.value = '{value}';"
            " s.dispatchEvent(new Event('change')); })()")


def check_layers(page):
    fills = "new Set(map.polygons.map((p) => p.style.fill)).size"
    for layer in ("leaf", "classes", "change"):
        choose(page, "layer", layer)
        check(page.js(fills) > 1, f"layer {layer} colours the panels")
    choose(page, "layer", "gaps")
    choose(page, "layer", "density")
    page.wait_for(f"{MAP}[0] > 1000")
    before = page.js(MAP)
    choose(page, "palette", "paper")
    page.wait_for(f"{MAP}[1] !== {before[1]}")
    choose(page, "palette", "canopy")
    page.wait_for(f"{MAP}[1] === {before[1]}")
    check(True, "another choice of colours recolours the map")
    marks = page.js("document.querySelectorAll('#scatter .pick').length")
    compared = page.js("panels.filter((p) => changeOf(p, chosen.a, chosen.b)).length")
    check(marks == compared and marks > 0, f"the scatter has {marks} panels")
    check("m²" in page.js("document.getElementById('pair-text').textContent"), "and says what changed")


def check_sizes(page, pictures):
    for scheme in ("light", "dark"):
        page.colours(scheme)
        dark = page.js("getComputedStyle(document.body).backgroundColor.match(/\\d+/g).slice(0, 3)"
                       ".every((v) => v < 60)")
        check(dark == (scheme == "dark"), f"{scheme} is {scheme}")
        for name in ("--ink", "--soft", "--accent", "--gain", "--loss", "--warn"):
            contrast = page.js(f"{CONTRAST}('{name}', '--card')")
            check(contrast >= 4.5, f"{scheme}: contrast of {name} is {contrast:.1f}")
        page.wait_for(SETTLED)
        if pictures:
            page.picture(pictures / f"desktop_{scheme}.png", whole=True)
    page.colours("light")
    page.resize(390, 844, 2, True)
    page.wait_for("document.documentElement.clientWidth === 390")
    page.wait_for(SETTLED)
    width = page.js("document.documentElement.scrollWidth")
    check(width <= 390, f"at 390 px nothing sticks out: {width} px")
    small = page.js("[...document.querySelectorAll('.chart text')]"
                    ".filter((t) => t.getBoundingClientRect().height < 9).length")
    check(small == 0, "and the charts' text stays readable")
    if pictures:
        page.picture(pictures / "phone.png", whole=True)
    page.resize(1280, 900)


def check_print(page, pictures):
    for scheme in ("light", "dark"):
        page.colours(scheme)
        pdf = page.pdf()
        pages = len(re.findall(rb"/Type\s*/Page\b", pdf))
        box = re.search(rb"/MediaBox\s*\[\s*0 0 ([\d.]+) ([\d.]+)", pdf)
        a4 = box is not None and abs(float(box[1]) - 595) < 2 and abs(float(box[2]) - 842) < 2
        check(a4, "it prints on A4")
        check(1 < pages < 15, f"on {pages} pages")
        if pictures:
            (pictures / f"print_{scheme}.pdf").write_bytes(pdf)
    page.colours("light")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--report", type=pathlib.Path, help="an existing report; its names are not checked")
    parser.add_argument("--pictures", type=pathlib.Path, help="folder for screenshots and the printed pages")
    arguments = parser.parse_args()
    chromium = find_chromium()
    if chromium is None:
        print("SKIPPED: there is no Chromium (package chromium, or RAYFIELD_CHROMIUM=/path/to/it)")
        return 77
    if arguments.pictures:
        arguments.pictures.mkdir(parents=True, exist_ok=True)
    report = arguments.report or make_report(arguments.program, arguments.work)
    try:
        page = Chromium(chromium)
    except (RuntimeError, OSError) as e:
        print(f"SKIPPED: {chromium} does not start here: {e}")
        return 77
    try:
        page.resize(1280, 900)
        page.colours("light")
        url = report.resolve().as_uri()
        page.open(url)
        page.wait_for(SETTLED)
        if arguments.report is None:
            check_text(page)
        check_dates(page)
        check_panels(page)
        check_layers(page)
        check_sizes(page, arguments.pictures)
        check_print(page, arguments.pictures)
        check(page.complaints == [], f"no message on the console: {page.complaints}")
        check(set(page.requests) == {url}, f"nothing was asked for but the file: {set(page.requests) - {url}}")
    finally:
        page.close()
    if failures:
        print(f"{len(failures)} checks FAILED")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
