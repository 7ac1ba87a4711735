#!/usr/bin/env python3
"""Draws what a wide beam does to what is measured: the two pictures of docs/beams.md.

    tests/accuracy/beam_pictures.py RAYFIELD WORK PICTURES

Simulates sim/sites/beam_lms511.toml (13.6 mm + 11.9 mrad) with several detection shares t, and with thin rays, from the
same places at the same times; the clouds lie in WORK and are not made again where they are there. Writes into PICTURES:

beam_post.svg     how often a beam returns from a post, by the distance of its axis from the post's, at three ranges
beam_density.svg  hits per metre of path in full leaf, over those of thin rays in the same canopy, by the beam's diameter

Needs python3-gdal and python3-numpy.
"""
import argparse
import json
import os
import pathlib
import re

import numpy as np

from site_files import Frame, read_csv, run

SHARES = [0.15, 0.25, 0.40]
BARE, LEAFY = "2019-08-06", "2020-01-22"
COLOURS = ["#1b6ca8", "#d1495b", "#3a7d44"]
TYPES = {"double": "<f8", "float": "<f4", "uchar": "u1"}


def simulate(rayfield, work, name, share):
    """Folder of the site with the detection share; thin rays where there is none."""
    site = pathlib.Path(__file__).parents[2].joinpath("sim/sites/beam_lms511.toml").read_text()
    if share is None:
        site = re.sub(r"(beam_diameter_m|divergence_mrad) = .*", r"\1 = 0", site)
    else:
        site = re.sub(r"detection_share = .*", f"detection_share = {share}", site)
    folder = work / name
    if not folder.exists():
        (work / f"{name}.toml").write_text(site)
        run(rayfield, "simulate", str(work / f"{name}.toml"), "-o", str(folder), "--no-log", "-q")
    return folder


class Cloud:
    """Rays of one date: origins and ends in map coordinates, range, whether they hit."""

    def __init__(self, folder):
        with open(folder / "rays.ply", "rb") as file:
            properties, count, crs = [], 0, None
            while (line := file.readline().decode("ascii").split()) != ["end_header"]:
                if line[:2] == ["comment", "crs"]:
                    crs = line[2]
                elif line[:2] == ["element", "vertex"]:
                    count = int(line[2])
                elif line[0] == "property":
                    properties.append((line[2], TYPES[line[1]]))
            data = np.fromfile(file, dtype=properties, count=count)
        self.end = np.column_stack([data["x"], data["y"], data["z"]])
        back = np.column_stack([data["nx"], data["ny"], data["nz"]]).astype(float)
        self.range, self.origin, self.hit = np.linalg.norm(back, axis=1), self.end + back, data["alpha"] > 0
        self.site = json.load(open(folder / "truth/site.json"))
        self.frame = Frame(self.site, crs)
        self.truth = folder / "truth"


def beam_diameter_m(range_m):
    return 0.0136 + 0.0119 * range_m


def post_returns(cloud, ranges_m, offsets_m):
    """Share of beams that return from a post below the cordon, (ranges, offsets), and the mean radius of the posts."""
    passed, returned = (np.zeros((len(ranges_m) - 1, len(offsets_m) - 1)) for _ in range(2))
    posts = [p for p in read_csv(cloud.truth / "posts.csv") if p["diameter_m"] < 0.1]
    direction = (cloud.end - cloud.origin) / cloud.range[:, None]
    flat = np.linalg.norm(direction[:, :2], axis=1)
    for post in posts:
        to = cloud.frame.map(post["e"], post["n"]) - cloud.origin[:, :2]
        along = (to * direction[:, :2]).sum(axis=1) / flat
        offset = np.abs(to[:, 0] * direction[:, 1] - to[:, 1] * direction[:, 0]) / flat
        range_m = along / flat
        height = cloud.origin[:, 2] + range_m * direction[:, 2] - (post["z"] + cloud.frame.alt)
        near = (along > 0.5) & (offset < offsets_m[-1]) & (height > 0.3) & (height < 0.8)
        near &= (cloud.range > range_m - 0.15) & (flat > 0.6)
        at_post = near & cloud.hit & (np.abs(cloud.range - range_m) < 0.15)
        for mask, counts in ((near, passed), (at_post, returned)):
            counts += np.histogram2d(range_m[mask], offset[mask], [ranges_m, offsets_m])[0]
    return returned / np.where(passed < 8, np.nan, passed), np.mean([p["diameter_m"] for p in posts]) / 2


def counts_by_diameter(cloud, edges_m, every=6, step_m=0.03):
    """Hits and metres of path in the canopies of the rows, by the beam's diameter."""
    path = np.zeros(len(edges_m) - 1)
    ground = np.array([cloud.frame.map(g["e"], g["n"]).tolist() + [g["z"] + cloud.frame.alt]
                       for g in read_csv(cloud.truth / "ground.csv")])
    rows = []
    for row in read_csv(cloud.truth / "rows.csv"):
        a, b = cloud.frame.map(row["e0"], row["n0"]), cloud.frame.map(row["e1"], row["n1"])
        axis, length = (b - a) / np.linalg.norm(b - a), np.linalg.norm(b - a)
        to = ground[:, :2] - a
        under = np.abs(to[:, 0] * axis[1] - to[:, 1] * axis[0]) < 0.3
        order = np.argsort(to[under] @ axis)
        rows.append((a, axis, length, (to[under] @ axis)[order], ground[under, 2][order]))

    def in_canopy(p):
        inside = np.zeros(len(p), bool)
        for a, axis, length, chainage, height in rows:
            to = p[:, :2] - a
            s, off = to @ axis, to[:, 0] * axis[1] - to[:, 1] * axis[0]
            up = p[:, 2] - np.interp(s, chainage, height)
            inside |= (s > 0.5) & (s < length - 0.5) & (np.abs(off) < 0.3) & (up > 0.95) & (up < 1.9)
        return inside

    origin, end, length, hit = (x[::every] for x in (cloud.origin, cloud.end, cloud.range, cloud.hit))
    direction = (end - origin) / length[:, None]
    for r in np.arange(0.6, 6.5, step_m):
        alive = length > r
        count = in_canopy(origin[alive] + r * direction[alive]).sum()
        path += step_m * count * np.histogram([beam_diameter_m(r)], edges_m)[0]
    ranges = length[hit][in_canopy(end[hit])]
    return np.histogram(beam_diameter_m(ranges), edges_m)[0], path


class Chart:
    """Lines over two axes as SVG."""

    WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 640, 360, 66, 170, 20, 52

    def __init__(self, x_range, y_range, x_label, y_label):
        self.x_range, self.y_range = x_range, y_range
        self.parts = [f'<rect width="{self.WIDTH}" height="{self.HEIGHT}" fill="white"/>']
        right, bottom = self.WIDTH - self.RIGHT, self.HEIGHT - self.BOTTOM
        for v in np.linspace(*x_range, 6):
            x = self.place(v, y_range[0])[0]
            self.parts.append(f'<line x1="{x:.1f}" y1="{bottom}" x2="{x:.1f}" y2="{bottom + 5}" stroke="#444"/>')
            self.text(x, bottom + 20, f"{v:g}", "middle")
        for v in np.linspace(*y_range, 6):
            y = self.place(x_range[0], v)[1]
            self.parts.append(f'<line x1="{self.LEFT}" y1="{y:.1f}" x2="{right}" y2="{y:.1f}" stroke="#ddd"/>')
            self.text(self.LEFT - 8, y + 4, f"{v:g}", "end")
        self.text((self.LEFT + right) / 2, self.HEIGHT - 10, x_label, "middle")
        middle = (self.TOP + bottom) / 2
        self.parts.append(f'<text transform="translate(18 {middle:.0f}) rotate(-90)" text-anchor="middle">{y_label}</text>')
        self.labels = 0

    def place(self, x, y):
        share = [(v - low) / (high - low) for v, (low, high) in ((x, self.x_range), (y, self.y_range))]
        return (self.LEFT + share[0] * (self.WIDTH - self.LEFT - self.RIGHT),
                self.HEIGHT - self.BOTTOM - share[1] * (self.HEIGHT - self.TOP - self.BOTTOM))

    def text(self, x, y, text, anchor="start", colour="#222"):
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}">{text}</text>')

    def line(self, xs, ys, colour, label, dashes=""):
        points = " ".join("{:.1f},{:.1f}".format(*self.place(x, y)) for x, y in zip(xs, ys) if np.isfinite(y))
        self.parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2" '
                          f'stroke-dasharray="{dashes}"/>')
        self.text(self.WIDTH - self.RIGHT + 12, self.TOP + 16 + 20 * self.labels, label, colour=colour)
        self.labels += 1

    def write(self, path):
        path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.WIDTH} {self.HEIGHT}" '
                        f'width="{self.WIDTH}" height="{self.HEIGHT}" font-family="sans-serif" font-size="13">\n'
                        + "\n".join(self.parts) + "\n</svg>\n")


def draw_post(cloud, path):
    ranges, offsets = np.array([1.4, 2.2, 3.2, 6.0]), np.arange(0, 0.101, 0.005)
    share, radius = post_returns(cloud, ranges, offsets)
    chart = Chart((0, 100), (0, 1), "beam's axis from the post's, mm", "share of beams that return from the post")
    for i, colour in enumerate(COLOURS):
        width = 1000 * beam_diameter_m((ranges[i] + ranges[i + 1]) / 2)
        chart.line(500 * (offsets[:-1] + offsets[1:]), share[i], colour,
                   f"{ranges[i]:g}–{ranges[i + 1]:g} m: {width:.0f} mm")
    chart.line([1000 * radius] * 2, [0, 1], "#666", "the post's edge", "4 4")
    chart.write(path)
    print("post's half width where half of the beams return, mm:",
          [round(float(1000 * np.interp(-0.5, -s, (offsets[:-1] + offsets[1:]) / 2)), 1) for s in share],
          f"true: {1000 * radius:.1f}")


def draw_density(clouds, thin, path):
    edges = np.array([0.025, 0.03, 0.035, 0.04, 0.05, 0.06, 0.075])
    middle = 500 * (edges[:-1] + edges[1:])
    thin_hits, thin_path = counts_by_diameter(thin, edges)
    chart = Chart((20, 80), (0, 2), "diameter of the beam, mm", "hits per metre, over thin rays")
    for share, colour in zip(SHARES, COLOURS):
        hits, metres = counts_by_diameter(clouds[share], edges)
        ratio = (hits / metres) / (thin_hits / thin_path)
        print(f"t = {share}:", dict(zip(middle.tolist(), ratio.round(2).tolist())))
        chart.line(middle, ratio, colour, f"t = {share:.2f}")
    chart.line([20, 80], [1, 1], "#666", "thin rays", "4 4")
    chart.write(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("rayfield")
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("pictures", type=pathlib.Path)
    options = parser.parse_args()
    os.makedirs(options.work, exist_ok=True)
    folders = {share: simulate(options.rayfield, options.work, f"t{round(100 * share)}", share) for share in SHARES}
    thin = simulate(options.rayfield, options.work, "thin", None)
    draw_post(Cloud(folders[0.25] / BARE), options.pictures / "beam_post.svg")
    draw_density({share: Cloud(folder / LEAFY) for share, folder in folders.items()}, Cloud(thin / LEAFY),
                 options.pictures / "beam_density.svg")


if __name__ == "__main__":
    main()
