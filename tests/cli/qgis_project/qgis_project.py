#!/usr/bin/env python3
"""Opens the project of an exported block in QGIS, without a display: layers, groups, styles, relation, labels, times,
and maps of every date. Opening it changes nothing in the GeoPackage.

    tests/cli/qgis_project/qgis_project.py PROGRAM WORK_FOLDER [--maps MAPS] [--pictures FOLDER]

Without --maps, a folder that `rayfield export` has written, a small site is simulated, mapped and given a hostile name.
Needs python3-qgis; `scripts/test.sh --qgis` installs it. No part of ctest: QGIS brings 300 packages.
"""
import argparse
import json
import os
import pathlib
import shutil
import sqlite3
import subprocess
import sys
import urllib.parse

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
from qgis.core import (  # noqa: E402
    QgsApplication, QgsMapRendererSequentialJob, QgsMapSettings, QgsProject, QgsRectangle, QgsTemporalNavigationObject)
from qgis.gui import QgsMapCanvas, QgsTemporalControllerWidget  # noqa: E402
from qgis.PyQt.QtCore import QSize  # noqa: E402
from qgis.PyQt.QtGui import QColor  # noqa: E402

SIZE = (1000, 800)
BLOCK = "Böll & \"Söhne\" 100 %? #1 <img src=x onerror=alert(1)>"
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
    if not truth:
        failures.append(what)
        print("FAILED " + what)


def make_maps(program, work):
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
    rayfield("registry", "rename", work / "block", "--block", BLOCK)
    rayfield("export", work / "block", "-o", work / "maps", "-q")
    return work / "maps"


def tables(path):
    """Every table with its rows, as SQLite reads them; the bytes of pages may differ."""
    with sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True) as connection:
        names = [row[0] for row in connection.execute(
            "SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'rtree_%_geom'")]
        return {name: connection.execute(f'SELECT * FROM "{name}"').fetchall() for name in sorted(names)}


def render(canvas_layers, extent, crs, time=None):
    settings = QgsMapSettings()
    settings.setLayers(canvas_layers)
    settings.setExtent(extent)
    settings.setDestinationCrs(crs)
    settings.setOutputSize(QSize(*SIZE))
    settings.setOutputDpi(110)
    settings.setBackgroundColor(QColor(176, 164, 140))  # bare soil, in place of imagery
    if time is not None:
        settings.setIsTemporal(True)
        settings.setTemporalRange(time)
    job = QgsMapRendererSequentialJob(settings)
    job.start()
    job.waitForFinished()
    return job.renderedImage()


def colours(image, step=3):
    """How many of the sampled pixels are not background."""
    background = image.pixelColor(1, 1).rgb()
    return sum(image.pixelColor(x, y).rgb() != background
               for x in range(0, image.width(), step) for y in range(0, image.height(), step))


class Block:
    def __init__(self, project):
        self.project = project
        self.root = project.layerTreeRoot()
        self.dates_group = self.root.findGroup("Dates, one at a time")
        self.dates = [g for g in self.dates_group.children() if not g.name().startswith("All dates")]
        self.seasons = [g for g in self.dates_group.children() if g.name().startswith("All dates")]
        self.extent = QgsRectangle(project.viewSettings().defaultViewExtent())

    def show(self, group):
        group.setItemVisibilityChecked(True)

    def visible(self):
        order = self.root.layerOrder()
        shown = {layer.layer() for layer in self.root.findLayers() if layer.isVisible()}
        return [layer for layer in order if layer in shown]

    def picture(self, time=None):
        return render(self.visible(), self.extent, self.project.crs(), time)


def check_layers(block, scans):
    project = block.project
    for layer in project.mapLayers().values():
        check(layer.isValid(), f"layer '{layer.name()}' opens ({layer.source()})")
    for node in block.root.findLayers():
        check(node.layer() is not None, f"'{node.name()}' in the tree has a layer")
    check(len(block.dates) == scans, f"{scans} dates have a group, found {len(block.dates)}")
    shown = [group.name() for group in block.dates_group.children() if group.isVisible()]
    check(shown == [block.dates[0].name()], f"the newest date alone is shown at first, not {shown}")
    check([group.name() for group in block.dates] == sorted((g.name() for g in block.dates), reverse=True),
          "dates stand newest first")
    check(project.mapLayer("rayfield_panel").featureCount() > 0, "panels are there")
    for i in range(scans):
        panels = project.mapLayer(f"rayfield_panels_{i + 1}")
        scan_ids = {feature["scan_id"] for feature in panels.getFeatures()}
        check(len(scan_ids) == 1, f"'{panels.source()}' holds one date, not {scan_ids}")
        styles = panels.styleManager().styles()
        check(set(styles) == {"one scale for all dates", "per cent of the date's mean"}, f"styles: {styles}")
    check(project.crs().isValid(), "the project has a coordinate reference system")


def check_relation(project):
    relations = project.relationManager().relations()
    check(len(relations) == 1, "one relation")
    for relation in relations.values():
        check(relation.isValid(), f"relation {relation.name()} holds")
        panel = next(project.mapLayer("rayfield_panel").getFeatures())
        rows = list(relation.getRelatedFeatures(panel))
        check(rows and all(row["panel_uid"] == panel["panel_uid"] for row in rows), "a panel's values are found")


def check_labels(project):
    for layer_id in ("rayfield_vine_row", "rayfield_panel"):
        layer = project.mapLayer(layer_id)
        check(layer.labelsEnabled() and layer.labeling() is not None, f"'{layer.name()}' is labelled")


def check_time(block, controller, canvas):
    check(controller.navigationMode() == QgsTemporalNavigationObject.Animated, "the temporal controller is on")
    days = len({group.name()[:10] for group in block.dates})
    check(controller.totalFrameCount() == days, f"one step per date: {controller.totalFrameCount()} for {days}")
    first = canvas.temporalRange().begin().toString("yyyy-MM-dd")
    print(f"the temporal controller begins at {first}, step {controller.currentFrameNumber() + 1} of "
          f"{controller.totalFrameCount()}")
    check(block.dates[0].name().startswith(first), f"it begins with the newest date, not {first}")


def check_pictures(block, controller, folder):
    """Every date is drawn, and differs from the others; so is every step of the temporal controller."""
    outlines = colours(render([l for l in block.visible() if l.id() in ("rayfield_vine_row", "rayfield_post", "rayfield_panel")], block.extent,
                              block.project.crs()))
    seen = []
    for group in block.dates:
        block.show(group)
        check([g.name() for g in block.dates_group.children() if g.isVisible()] == [group.name()],
              "showing one date hides the others")
        images = {"panels": block.picture()}
        for node in group.findLayers():
            if node.layer().id().startswith("rayfield_plan_density_") and "_se_" not in node.layer().id():
                node.setItemVisibilityChecked(True)
                panels = [n for n in group.findLayers() if n.layer().id().startswith("rayfield_panels_")]
                for panel in panels:
                    panel.setItemVisibilityChecked(False)
                images["density"] = block.picture()
                node.setItemVisibilityChecked(False)
                for panel in panels:
                    panel.setItemVisibilityChecked(True)
        panels = [n.layer() for n in group.findLayers() if n.layer().id().startswith("rayfield_panels_")][0]
        panels.styleManager().setCurrentStyle("per cent of the date's mean")
        images["relative"] = block.picture()
        panels.styleManager().setCurrentStyle("one scale for all dates")
        for kind, image in images.items():
            name = f"{group.name()[:10]}_{kind}"
            if folder:
                image.save(os.path.join(folder, name + ".png"))
            check(colours(image) >= outlines, f"{name} is drawn")
            check(all(image != other for other in seen), f"{name} is unlike the others")
            seen.append(image)
    for group in block.seasons:
        block.show(group)
        images = [block.picture(controller.dateTimeRangeForFrameNumber(i)) for i in range(controller.totalFrameCount())]
        for i, image in enumerate(images):
            if folder:
                image.save(os.path.join(folder, f"{group.findLayers()[0].layer().id()}_step_{i + 1}.png"))
            check(all(image != other for other in images[:i]), f"'{group.name()}': step {i + 1} shows another date")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--maps", type=pathlib.Path)
    parser.add_argument("--pictures")
    arguments = parser.parse_args()
    if arguments.pictures:
        os.makedirs(arguments.pictures, exist_ok=True)
    maps = arguments.maps or make_maps(arguments.program, arguments.work)
    # Paths are relative: a copy in a folder whose name needs quoting works the same.
    folder = arguments.work / "a copy, 100 % O'Brien's"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(maps, folder)
    paths = list(folder.glob("*.gpkg"))
    check(len(paths) == 1, f"one GeoPackage in {maps}, not {paths}")
    path = paths[0]
    before = tables(path)
    names = [name for name, metadata, _ in before["qgis_projects"] if json.loads(metadata)["last_modified_user"] == "rayfield"]
    check(len(names) == 1, f"one project of rayfield's, not {names}")

    application = QgsApplication([], True)
    application.initQgis()
    widget = QgsTemporalControllerWidget()
    canvas = QgsMapCanvas()
    canvas.setTemporalController(widget.temporalController())
    project = QgsProject.instance()
    uri = f"geopackage:{urllib.parse.quote(str(path))}?projectName={urllib.parse.quote(names[0])}"
    check(project.read(uri), f"the project opens: {project.error()}")
    block = Block(project)
    check_layers(block, len(before["scan"]))
    check_relation(project)
    check_labels(project)
    check_time(block, widget.temporalController(), canvas)
    check_pictures(block, widget.temporalController(), arguments.pictures)
    project.clear()
    check(tables(path) == before, "opening and drawing changes no row of any table")
    left = sorted(set(os.listdir(folder)) - set(os.listdir(maps)))
    check(not left, f"QGIS leaves nothing beside the GeoPackage, not {left}")
    print(f"{len(failures)} failures" if failures else "QGIS opens the project as it should")
    sys.stdout.flush()
    os._exit(1 if failures else 0)  # QGIS may crash when Python takes it down


main()
