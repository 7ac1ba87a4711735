#!/usr/bin/env python3
"""Draws the pictures of docs/qgis.md: the project of an exported block, drawn by QGIS without a display.

    scripts/qgis_pictures.py MAPS FOLDER    (MAPS: of the demonstration, out/demo/maps; needs python3-qgis)
"""
import json
import os
import pathlib
import sqlite3
import sys
import urllib.parse

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
from qgis.core import (  # noqa: E402
    QgsApplication, QgsLayoutExporter, QgsLayoutItemLabel, QgsLayoutItemLegend, QgsLayoutItemMap, QgsLayoutPoint,
    QgsLayoutSize, QgsLegendRenderer, QgsLegendStyle, QgsMapLayerLegendUtils, QgsMapLayerType, QgsPrintLayout, QgsProject)
from qgis.PyQt.QtGui import QColor, QFont  # noqa: E402

SOIL = QColor(176, 164, 140)  # in place of imagery
DPI = 130


class Sheet:
    """A page with maps side by side and a legend on the right; lengths in mm."""

    def __init__(self, project, width, height):
        self.layout = QgsPrintLayout(project)
        self.layout.initializeDefaults()
        self.layout.pageCollection().page(0).setPageSize(QgsLayoutSize(width, height))

    def map(self, layers, extent, x, y, width, height):
        item = QgsLayoutItemMap(self.layout)
        item.setRect(0, 0, 1, 1)  # without it the map has no extent
        self.layout.addLayoutItem(item)
        item.attemptMove(QgsLayoutPoint(x, y))
        item.attemptResize(QgsLayoutSize(width, height))
        item.setLayers(layers)
        item.setBackgroundColor(SOIL)
        item.zoomToExtent(extent)

    def text(self, words, x, y, size=11):
        item = QgsLayoutItemLabel(self.layout)
        item.setText(words)
        item.setFont(QFont("DejaVu Sans", size))
        self.layout.addLayoutItem(item)
        item.adjustSizeToText()
        item.attemptMove(QgsLayoutPoint(x, y))

    def legend(self, layer, title, x, y):
        item = QgsLayoutItemLegend(self.layout)
        item.setTitle(title)
        item.setAutoUpdateModel(False)
        root = item.model().rootGroup()
        root.removeAllChildren()
        root.addLayer(layer)
        for style in (QgsLegendStyle.Title, QgsLegendStyle.Subgroup, QgsLegendStyle.SymbolLabel):
            item.setStyleFont(style, QFont("DejaVu Sans", 8))
        if layer.type() == QgsMapLayerType.RasterLayer:  # the colour bar alone, without the name of the band
            QgsMapLayerLegendUtils.setLegendNodeOrder(root.findLayer(layer), [1])
            item.model().refreshLayerLegend(root.findLayer(layer))
            item.setSymbolHeight(60)
        QgsLegendRenderer.setNodeLegendStyle(root.findLayer(layer), QgsLegendStyle.Hidden)
        self.layout.addLayoutItem(item)
        item.attemptMove(QgsLayoutPoint(x, y))

    def save(self, path):
        settings = QgsLayoutExporter.ImageExportSettings()
        settings.dpi = DPI
        settings.generateWorldFile = False
        if QgsLayoutExporter(self.layout).exportToImage(str(path), settings) != QgsLayoutExporter.Success:
            sys.exit(f"cannot write {path}")


def block_extent(project):
    return project.mapLayer("rayfield_panel").extent().buffered(3)


def dates(project):
    groups = project.layerTreeRoot().findGroup("Dates, one at a time").children()
    return [group.name() for group in reversed(groups) if not group.name().startswith("All dates")]


def draw_panels(project, outlines, extent, path):
    newest = len(dates(project))
    panels = project.mapLayer(f"rayfield_panels_{newest}")
    sheet = Sheet(project, 165, 110)
    for x, style, title in ((3, "one scale for all dates", "Leaf area, m² per metre of row"),
                            (84, "per cent of the date's mean", "Per cent of the date's mean")):
        layer = panels.clone()
        layer.styleManager().setCurrentStyle(style)
        project.addMapLayer(layer, False)
        sheet.map(outlines + [layer], extent, x, 10, 43, 97)
        sheet.text(title, x, 3, 9)
        sheet.legend(layer, "", x + 44, 8)
    sheet.save(path)


def draw_season(project, outlines, extent, path):
    names = dates(project)
    sheet = Sheet(project, 60 * len(names) + 42, 122)
    without_numbers = [layer for layer in outlines if layer.id() != "rayfield_panel"]
    for i, name in enumerate(names):
        density = project.mapLayer(f"rayfield_plan_density_{i + 1}")
        sheet.map(without_numbers + [density], extent, 3 + 60 * i, 11, 58, 108)
        sheet.text(name[:10], 3 + 60 * i, 4)
    sheet.legend(density, "Canopy density, m²/m²", 60 * len(names) + 3, 11)
    sheet.save(path)


def main():
    maps, folder = map(pathlib.Path, sys.argv[1:])
    package = next(maps.glob("*.gpkg")).absolute()
    with sqlite3.connect(f"{package.as_uri()}?mode=ro", uri=True) as connection:
        rows = connection.execute("SELECT name, metadata FROM qgis_projects").fetchall()
    name = next(name for name, metadata in rows if json.loads(metadata)["last_modified_user"] == "rayfield")
    application = QgsApplication([], True)
    application.initQgis()
    project = QgsProject.instance()
    uri = f"geopackage:{urllib.parse.quote(str(package))}?projectName={urllib.parse.quote(name)}"
    if not project.read(uri):
        sys.exit(project.error())
    outlines = [project.mapLayer(f"rayfield_{layer}") for layer in ("vine_row", "post", "panel")]
    extent = block_extent(project)
    draw_panels(project, outlines, extent, folder / "qgis_panels.png")
    draw_season(project, outlines, extent, folder / "qgis_season.png")
    sys.stdout.flush()
    os._exit(0)  # QGIS may crash when Python takes it down


main()
