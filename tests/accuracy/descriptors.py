#!/usr/bin/env python3
"""Holds the canopy descriptors of simulated sites against what their leaves say (docs/descriptors.md).

    tests/accuracy/descriptors.py RAYFIELD OUT SITE.toml... [--leaves 0.1 1] [--set KEY=VALUE ...] [--reuse] [--json FILE]

For every site: simulate the dormant date and those with the given shares of the leaves, init, add (true poses, with the
rig), process, export; then every descriptor of every panel and of every half metre against truth. Sites need a date
without leaves, whose wood is subtracted; --no-wood leaves it out and compares with leaves and thin wood together. Prints
a Markdown table; reports only. Needs python3-gdal and python3-numpy.
"""
import argparse
import glob
import json
import os
import subprocess
import tomllib

import numpy as np
from site_files import Frame, read_csv, rows_of, run

FRUIT_ZONE_M = (0.8, 1.2)  # the default of the program; truth knows bands of 5 cm
PANEL = [("canopy_height_m", "height_m", "height, m"), ("canopy_width_m", "width_m", "width, m"),
         ("canopy_base_m", "base_m", "lower edge, m"), ("row_gap_share", "row_gap_share", "gap share"),
         ("porosity", "porosity", "porosity"), ("leaf_layer_number", "leaf_layer_number", "leaf layer number"),
         ("exposed_leaf_share", "exposed_leaf_share", "exposed leaf share"),
         ("fruit_zone_area_per_m", "fruit_zone", "fruit zone, m²/m"),
         ("fruit_zone_density", "fruit_zone_density", "fruit zone, m²/m³")]


def true_panels(truth):
    """Panels with all that is known of them."""
    bands = read_csv(f"{truth}/canopy_profile.csv")
    panels = []
    for panel, canopy in zip(read_csv(f"{truth}/panels.csv"), read_csv(f"{truth}/canopy.csv")):
        assert (panel["row"], panel["panel"]) == (canopy["row"], canopy["panel"])
        item = {**panel, **canopy}
        item["profile"] = [b for b in bands if (b["row"], b["panel"]) == (panel["row"], panel["panel"])]
        zone = sum(b["leaf_area_m2"] for b in item["profile"]
                   if b["height_low_m"] > FRUIT_ZONE_M[0] - 0.001 and b["height_high_m"] < FRUIT_ZONE_M[1] + 0.001)
        item["fruit_zone"] = zone / panel["length_m"]
        if item["width_m"]:
            item["fruit_zone_density"] = item["fruit_zone"] / (item["width_m"] * (FRUIT_ZONE_M[1] - FRUIT_ZONE_M[0]))
        panels.append(item)
    return panels


def pairs_of_panels(gpkg, scan_id, truth, frame):
    panels = {p["panel_uid"]: p for p in rows_of(gpkg, "panel")}
    profiles = {}
    for band in rows_of(gpkg, "panel_profile"):
        if band["scan_id"] == scan_id:
            profiles.setdefault(band["panel_uid"], []).append(band)
    centres = {uid: np.array(p["geometry"].Centroid().GetPoint_2D()) for uid, p in panels.items()}
    values = [v for v in rows_of(gpkg, "panel_value") if v["scan_id"] == scan_id]
    pairs = []
    for t in true_panels(truth):
        centre = frame.map((t["e0"] + t["e1"]) / 2, (t["n0"] + t["n1"]) / 2)
        near = min(values, key=lambda v: np.linalg.norm(centres[v["panel_uid"]] - centre))
        if np.linalg.norm(centres[near["panel_uid"]] - centre) < 0.35 * t["length_m"]:
            near["profile"] = profiles[near["panel_uid"]]
            pairs.append((near, t))
    return pairs


def pairs_of_metres(gpkg, scan_id, truth, frame):
    true = [{**m, **c} for m, c in zip(read_csv(f"{truth}/metres.csv"), read_csv(f"{truth}/canopy_metres.csv"))]
    places = np.array([frame.map(t["e"], t["n"]) for t in true])
    pairs = []
    for metre in rows_of(gpkg, "row_metre"):
        distance = np.linalg.norm(places - np.array(metre["geometry"].GetPoint_2D()), axis=1)
        if metre["scan_id"] == scan_id and distance.min() < 0.15:
            pairs.append((metre, true[int(np.argmin(distance))]))
    return pairs


def errors(pairs, name, true_name):
    """Count, true mean, bias and rms of what both know; how often only one of them does."""
    known, alone = [], 0
    for value, true in pairs:
        a, b = value.get(name), true.get(true_name)
        if isinstance(a, float) and isinstance(b, float):
            known.append((a, b))
        elif isinstance(a, float) != isinstance(b, float):
            alone += 1
    if not known:
        return None
    a, b = np.array(known).T
    return {"count": len(known), "alone": alone, "true": float(b.mean()), "bias": float((a - b).mean()),
            "rms": float(np.sqrt(((a - b) ** 2).mean())), "spread": float(b.std())}


def profile_errors(pairs):
    """Of leaf area per band and metre of row, over all bands of all panels."""
    found = []
    for value, true in pairs:
        for band in value["profile"]:
            if band["leaf_area_m2"] is None:
                continue
            area = sum(b["leaf_area_m2"] for b in true["profile"] if b["height_low_m"] > band["height_low_m"] - 0.001
                       and b["height_high_m"] < band["height_high_m"] + 0.001)
            if area > 0 or band["leaf_area_m2"] > 0:
                found.append((band["leaf_area_m2"] / true["length_m"], area / true["length_m"]))
    if not found:
        return None
    a, b = np.array(found).T
    return {"count": len(found), "alone": 0, "true": float(b.mean()), "bias": float((a - b).mean()),
            "rms": float(np.sqrt(((a - b) ** 2).mean())), "spread": float(b.std())}


def measure(rayfield, site_file, out, shares, settings, with_wood, reuse):
    name = os.path.splitext(os.path.basename(site_file))[0]
    folder = f"{out}/{name}"
    subprocess.run(["rm", "-rf", *glob.glob(f"{folder}/block*"), *glob.glob(f"{folder}/maps*")], check=True)
    with open(site_file, "rb") as file:
        drives = {d["date"] + ("_" + d["name"] if d.get("name") else ""): d.get("leaf_fraction", 1)
                  for d in tomllib.load(file)["date"]}
    bare = [d for d in sorted(drives) if drives[d] == 0][:1] if with_wood else []
    scans = bare + [d for d in sorted(drives) if drives[d] in shares]
    ids = []
    for scan in scans:
        logs = f"{folder}/logs/{scan}"
        if not (reuse and os.path.isdir(logs)):
            run(rayfield, "simulate", site_file, "-o", f"{folder}/logs", "--date", scan, "--overwrite", "-q")
        site = json.load(open(f"{logs}/truth/site.json"))
        crs = f"EPSG:{site['epsg']}"
        if not ids:
            run(rayfield, "init", f"{folder}/block", "--crs", crs)
        ids.append(run(rayfield, "add", f"{folder}/block", f"{logs}/rays.ply", "--date", scan.partition("_")[0],
                       "--rig", f"{logs}/rig.toml", "--json", "-q")["scan_id"])
        if not reuse:
            for path in glob.glob(f"{logs}/*.ply") + glob.glob(f"{logs}/*.bag"):
                os.remove(path)
    run(rayfield, "process", f"{folder}/block", "-q", *[a for s in settings for a in ("--set", s)])
    run(rayfield, "export", f"{folder}/block", "-o", f"{folder}/maps", "--format", "gpkg,csv", "-q")
    gpkg = glob.glob(f"{folder}/maps/*.gpkg")[0]
    results = []
    for scan, scan_id in zip(scans, ids):
        truth = f"{folder}/logs/{scan}/truth"
        frame = Frame(json.load(open(f"{truth}/site.json")), crs)
        panels, metres = pairs_of_panels(gpkg, scan_id, truth, frame), pairs_of_metres(gpkg, scan_id, truth, frame)
        figures = {}
        for column, true, title in PANEL:
            if not with_wood and true == "leaf_layer_number":
                true = "canopy_layer_number"
            figures[title] = {"panels": errors(panels, column, true), "metres": errors(metres, column, true)}
        figures["profile, m²/m per band"] = {"panels": profile_errors(panels), "metres": None}
        results.append((name, scan_id, drives[scan], figures))
    return results


def cell(f):
    return "–" if f is None else f"{f['bias']:+.3f}, {f['rms']:.3f}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("rayfield")
    parser.add_argument("out")
    parser.add_argument("sites", nargs="+")
    parser.add_argument("--leaves", nargs="+", type=float, default=[0.1, 1.0])
    parser.add_argument("--set", nargs="*", default=[], dest="settings")
    parser.add_argument("--no-wood", action="store_true")
    parser.add_argument("--reuse", action="store_true", help="keep simulated clouds, and take those of an earlier run")
    parser.add_argument("--json")
    arguments = parser.parse_args()
    print("| descriptor | site | leaves | true mean (spread of panels) | panels: bias, rms | half metres: bias, rms | known to one only |")
    print("|---|---|---|---|---|---|---|")
    everything = []
    for site_file in arguments.sites:
        for name, scan_id, leaves, figures in measure(arguments.rayfield, site_file, arguments.out, arguments.leaves,
                                                      arguments.settings, not arguments.no_wood, arguments.reuse):
            everything.append({"site": name, "scan": scan_id, "leaves": leaves, "figures": figures})
            for title, f in figures.items():
                p, m = f["panels"], f["metres"]
                if p is None and m is None:
                    continue
                true = "–" if p is None else f"{p['true']:.3f} ({p['spread']:.3f})"
                alone = (p["alone"] if p else 0), (m["alone"] if m else 0)
                print(f"| {title} | {name} | {100 * leaves:.0f} % | {true} | {cell(p)} | {cell(m)} | {alone[0]}, {alone[1]} |",
                      flush=True)
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(everything, file, indent=1)


if __name__ == "__main__":
    main()
