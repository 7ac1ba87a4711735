"""Reading of what the accuracy scripts hold against each other: products, and the simulation's truth. Needs python3-gdal and
python3-numpy.
"""
import csv
import json
import subprocess
import sys

import numpy as np
from osgeo import gdal, ogr, osr

gdal.UseExceptions()


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit {done.returncode}: {done.stderr.strip()[-2000:]}")
    return json.loads(done.stdout) if "--json" in command else done.stdout


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def read_csv(path):
    with open(path, newline="") as file:
        return [{k: number(v) for k, v in row.items()} for row in csv.DictReader(file)]


class Frame:
    """Local east-north-up metres of a site → map coordinates."""

    def __init__(self, site, crs):
        source, target = osr.SpatialReference(), osr.SpatialReference()
        target.SetFromUserInput(crs)
        source.CopyGeogCSFrom(target)
        for system in (source, target):
            system.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
        self.transform = osr.CoordinateTransformation(source, target)
        self.lat, self.lon, self.alt = site["lat"], site["lon"], site["alt"]
        a, f = source.GetSemiMajor(), 1 / source.GetInvFlattening()
        e2, s = f * (2 - f), np.sin(np.radians(self.lat))
        self.prime = a / np.sqrt(1 - e2 * s * s)
        self.meridian = a * (1 - e2) / (1 - e2 * s * s) ** 1.5
        self.zero = self._grid(0, 0)
        self.jacobian = np.column_stack([(self._grid(50, 0) - self._grid(-50, 0)) / 100,
                                         (self._grid(0, 50) - self._grid(0, -50)) / 100])

    def _grid(self, e, n):
        lon = self.lon + np.degrees(e / ((self.prime + self.alt) * np.cos(np.radians(self.lat))))
        lat = self.lat + np.degrees(n / (self.meridian + self.alt))
        return np.array(self.transform.TransformPoint(lon, lat)[:2])

    def map(self, e, n):
        return self.zero + self.jacobian @ np.array([e, n])


def raster(path):
    data = gdal.Open(path)
    return data.ReadAsArray(), data.GetGeoTransform()


def sample(path, points):
    """Bilinear values of a raster at map points; NaN outside."""
    values, g = raster(path)
    out = np.full(len(points), np.nan)
    for i, (x, y) in enumerate(points):
        c, r = (x - g[0]) / g[1] - 0.5, (y - g[3]) / g[5] - 0.5
        c0, r0 = int(np.floor(c)), int(np.floor(r))
        if 0 <= c0 < values.shape[1] - 1 and 0 <= r0 < values.shape[0] - 1:
            u, v = c - c0, r - r0
            out[i] = ((values[r0, c0] * (1 - u) + values[r0, c0 + 1] * u) * (1 - v)
                      + (values[r0 + 1, c0] * (1 - u) + values[r0 + 1, c0 + 1] * u) * v)
    return out


def rows_of(gpkg, layer):
    source = ogr.Open(gpkg)
    out = []
    for feature in source.GetLayerByName(layer):
        item = feature.items()
        geometry = feature.GetGeometryRef()
        if geometry is not None:
            item["geometry"] = geometry.Clone()
        out.append(item)
    return out


def rotations(q):
    """Rotation matrices of quaternions (x y z w), n × 3 × 3."""
    x, y, z, w = q.T
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
                     2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                     2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], -1).reshape(-1, 3, 3)
