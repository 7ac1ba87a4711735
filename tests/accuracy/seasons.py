#!/usr/bin/env python3
"""Many dates of one block, from raw logs: SLAM, alignment to the first date, maps; all against the simulation's truth.

    tests/accuracy/seasons.py build/release/cli/rayfield OUT sim/sites/seasons_*.toml

Per site: how far posts come to lie from where the first date has them (from the trajectories that SLAM left with each
scan, moved as the scan was), panels of each date, half metres and panels between repeated drives, the sign of change.
Prints Markdown tables; exit code 1 where a target is missed (--report-only: 0). Needs python3-gdal and python3-numpy.
"""
import argparse
import bz2
import glob
import json
import os
import subprocess
import sys
import tomllib

import numpy as np

from site_files import Frame, read_csv, rotations, rows_of, run

TARGETS = {"posts_m": 0.02, "total": 0.03, "repeat": 0.02, "repeat_half_metre": 0.08, "sign": 0.95,
           "leaf_total": 0.05, "leaf_rrmse": 0.06, "bare_m2": 0.1}


def snapshot_of(store):
    newest = sorted(glob.glob(f"{store}/snapshots/*.json"))[-1]
    with open(newest) as file:
        content = json.load(file)
    return content.get("snapshot", content)


def spline_basis(u, spans):
    u = np.clip(u, 0, spans)
    span = np.minimum(spans - 1, np.floor(u).astype(int))
    t = u - span
    return span, np.stack([(1 - t) ** 3, 4 - 6 * t**2 + 3 * t**3, 1 + 3 * t + 3 * t**2 - 3 * t**3, t**3], -1) / 6


def moved(points, alignment):
    """Map points (n × 3) of a drive as its scan was moved onto the block's reference; `alignment` is alignment.json."""
    if not alignment or alignment["verdict"] != "aligned":
        return points
    c, s = np.cos(alignment["yaw_rad"]), np.sin(alignment["yaw_rad"])
    pivot = np.array(alignment["pivot_m"])
    out = points.copy()
    out[:, :2] = (points[:, :2] - pivot) @ np.array([[c, s], [-s, c]]) + pivot
    out += np.array(alignment["offset_m"])
    warp = alignment.get("warp")
    if warp:
        control = np.array(warp["control_m"]).reshape(warp["ny"], warp["nx"], 3)
        sx, wx = spline_basis((out[:, 0] - warp["origin_m"][0]) / warp["spacing_m"], warp["nx"] - 3)
        sy, wy = spline_basis((out[:, 1] - warp["origin_m"][1]) / warp["spacing_m"], warp["ny"] - 3)
        for j in range(4):
            for i in range(4):
                out = out + (wy[:, j] * wx[:, i])[:, None] * control[sy + j, sx + i]
    return out


def posts_as_scanned(store, scan, truth, posts):
    """Where rays put each true post: its place carried by the errors of the poses from which it was seen (within 5 m),
    then moved with the scan."""
    attached = {a["name"]: f"{store}/{a['file']['path'] if 'file' in a else a['path']}" for a in scan["attachments"]}
    with bz2.open(next(p for n, p in attached.items() if n.endswith(".tum.bz2"))) as file:
        estimate = np.loadtxt(file)
    with open(attached["alignment.json"]) as file:
        alignment = json.load(file)
    true = np.loadtxt(f"{truth}/trajectory_map.tum")
    estimate = estimate[(estimate[:, 0] >= true[0, 0]) & (estimate[:, 0] <= true[-1, 0])][::5]
    nearest = np.clip(np.searchsorted(true[:, 0], estimate[:, 0]), 0, len(true) - 1)
    at = np.column_stack([np.interp(estimate[:, 0], true[:, 0], true[:, k]) for k in (1, 2, 3)])
    turn_true, turn = rotations(true[nearest, 4:8]), rotations(estimate[:, 4:8])
    places = []
    for post in posts:
        seen = np.linalg.norm(at[:, :2] - post[:2], axis=1) < 5
        local = np.einsum("nji,nj->ni", turn_true[seen], post - at[seen])
        places.append((np.einsum("nij,nj->ni", turn[seen], local) + estimate[seen, 1:4]).mean(0))
    return moved(np.array(places), alignment)


def panel_pairs(values, centres, frame, true_panels):
    """(measured, truth) of panels told by place, after the middles of all panels are laid on each other: the block lies
    where the GPS of its first date put it."""
    true_centres = np.array([frame.map((t["e0"] + t["e1"]) / 2, (t["n0"] + t["n1"]) / 2) for t in true_panels])
    offset = np.mean(list(centres.values()), axis=0) - true_centres.mean(0)
    pairs = []
    for v in values:
        distance = np.linalg.norm(true_centres + offset - centres[v["panel_uid"]], axis=1)
        best = int(np.argmin(distance))
        if v["plant_area_m2"] is not None and distance[best] < 0.35 * true_panels[best]["length_m"]:
            pairs.append((v, true_panels[best]))
    return pairs


def rrmse(x, y):
    return float(np.sqrt(np.mean((x - y) ** 2)) / np.mean([x, y]))


def half_metres(gpkg, scan_id):
    return {(m["row_number"], round(m["chainage_m"], 2)): m["plant_area_per_m"]
            for m in rows_of(gpkg, "row_metre") if m["scan_id"] == scan_id and m["plant_area_per_m"] is not None}


def measure_site(arguments, site_file):
    name = os.path.splitext(os.path.basename(site_file))[0]
    folder = f"{arguments.out}/{name}"
    if not arguments.reuse:
        subprocess.run(["rm", "-rf", folder], check=True)
    subprocess.run(["rm", "-rf", f"{folder}/block", f"{folder}/maps"], check=True)
    with open(site_file, "rb") as file:
        dates = sorted(str(d["date"]) for d in tomllib.load(file)["date"])
    block, maps = f"{folder}/block", f"{folder}/maps"
    for date in dates:
        scan = f"{folder}/logs/{date}"
        if not os.path.isdir(scan):
            run(arguments.rayfield, "simulate", site_file, "-o", f"{folder}/logs", "--date", date, "--no-rays", "-q")
        if not os.path.exists(f"{block}/store.json"):
            crs = f"EPSG:{json.load(open(scan + '/truth/site.json'))['epsg']}"
            run(arguments.rayfield, "init", block, "--crs", crs)
        run(arguments.rayfield, "add", block, f"{scan}/scan.bag", "--rig", f"{scan}/rig.toml", "--date", date, "-q")
        if not arguments.keep and not arguments.reuse:
            os.remove(f"{scan}/scan.bag")
    run(arguments.rayfield, "process", block, "-q")
    run(arguments.rayfield, "export", block, "-o", maps, "--format", "gpkg", "-q")

    gpkg = glob.glob(f"{maps}/*.gpkg")[0]
    centres = {p["panel_uid"]: np.array(p["geometry"].Centroid().GetPoint_2D()) for p in rows_of(gpkg, "panel")}
    values = rows_of(gpkg, "panel_value")
    scans = {s["scan_id"]: s for s in snapshot_of(block)["scans"]}
    site = json.load(open(f"{folder}/logs/{dates[0]}/truth/site.json"))
    frame = Frame(site, crs)
    posts = [np.array([*frame.map(p["e"], p["n"]), site["alt"] + p.get("z", p.get("ground_m", 0))])
             for p in read_csv(f"{folder}/logs/{dates[0]}/truth/posts.csv")]
    figures, first, by_panel = {"dates": {}}, None, {}
    for date in dates:
        truth = f"{folder}/logs/{date}/truth"
        places = posts_as_scanned(block, scans[date], truth, posts)
        first = places if first is None else first
        pairs = panel_pairs([v for v in values if v["scan_id"] == date], centres, frame, read_csv(f"{truth}/panels.csv"))
        plant = np.array([v["plant_area_m2"] for v, _ in pairs])
        leaf = np.array([v["leaf_area_m2"] for v, _ in pairs])
        true_leaf = np.array([t["leaf_area_m2"] for _, t in pairs])
        true_plant = true_leaf + np.array([t["wood_area_m2"] for _, t in pairs])
        inside = [v["ci_low_m2"] <= t["leaf_area_m2"] <= v["ci_high_m2"] for v, t in pairs if v["ci_low_m2"] is not None]
        plant_inside = [v["plant_ci_low_m2"] <= t <= v["plant_ci_high_m2"] for (v, _), t in zip(pairs, true_plant)]
        by_panel[date] = {v["panel_uid"]: (v, t) for v, t in pairs}
        alignment = scans[date].get("alignment", {})
        figures["dates"][date] = {
            "panels": len(pairs), "posts_m": float(np.sqrt((np.linalg.norm((places - first)[:, :2], axis=1) ** 2).mean())),
            "residual_m": alignment.get("residual_m", float("nan")), "shift_m": float(np.linalg.norm(alignment.get("offset_m", [0, 0])[:2])),
            "total": plant.sum() / true_plant.sum(), "rrmse": float(np.sqrt(np.mean((plant - true_plant) ** 2)) / true_plant.mean()),
            "slope": float(np.polyfit(true_plant, plant, 1)[0]), "plant_in_interval": float(np.mean(plant_inside)),
            "leaf_total": leaf.sum() / true_leaf.sum() if true_leaf.sum() > 0 else float("nan"),
            "leaf_rrmse": float(np.sqrt(np.mean((leaf - true_leaf) ** 2)) / true_leaf.mean()) if true_leaf.sum() > 0 else float("nan"),
            "leaf_worst_m2": float(np.abs(leaf - true_leaf).max()), "true_leaf_m2": float(true_leaf.sum()),
            "in_interval": float(np.mean(inside)) if inside else float("nan")}
    right, clear = 0, 0
    for i, a in enumerate(dates):
        for b in dates[i + 1:]:
            common = [u for u in by_panel[a] if u in by_panel[b]]
            same = abs(figures["dates"][a]["true_leaf_m2"] - figures["dates"][b]["true_leaf_m2"]) < 1e-6
            if same and figures["dates"][a]["true_leaf_m2"] > 0:
                x, y = (np.array([by_panel[d][u][0]["plant_area_m2"] for u in common]) for d in (a, b))
                ha, hb = half_metres(gpkg, a), half_metres(gpkg, b)
                keys = [k for k in ha if k in hb]
                figures["repeat"] = rrmse(x, y)
                figures["repeat_half_metre"] = rrmse(np.array([ha[k] for k in keys]), np.array([hb[k] for k in keys]))
            for u in common:
                (va, ta), (vb, tb) = by_panel[a][u], by_panel[b][u]
                change = tb["leaf_area_m2"] - ta["leaf_area_m2"]
                error = np.hypot((va["ci_high_m2"] - va["ci_low_m2"]) / 3.92, (vb["ci_high_m2"] - vb["ci_low_m2"]) / 3.92)
                if abs(change) > 2 * error:
                    clear += 1
                    right += np.sign(vb["leaf_area_m2"] - va["leaf_area_m2"]) == np.sign(change)
    figures["sign"], figures["clear_changes"] = (right / clear if clear else float("nan")), clear
    if not arguments.keep and not arguments.reuse:
        subprocess.run(["rm", "-rf", folder], check=True)
    return name, figures


def misses(f):
    out = [f"{d}: posts" for d, x in f["dates"].items() if x["posts_m"] > TARGETS["posts_m"]]
    out += [f"{d}: total" for d, x in f["dates"].items() if abs(x["total"] - 1) > TARGETS["total"]]
    for d, x in f["dates"].items():
        if x["true_leaf_m2"] == 0:
            out += [f"{d}: bare"] if x["leaf_worst_m2"] > TARGETS["bare_m2"] else []
        elif abs(x["leaf_total"] - 1) > TARGETS["leaf_total"] or x["leaf_rrmse"] > TARGETS["leaf_rrmse"]:
            out.append(f"{d}: leaves")
    for key in ("repeat", "repeat_half_metre"):
        if f.get(key, 0) > TARGETS[key]:
            out.append(key)
    if f["clear_changes"] and f["sign"] < TARGETS["sign"]:
        out.append("sign")
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rayfield")
    parser.add_argument("out")
    parser.add_argument("sites", nargs="+")
    parser.add_argument("--json")
    parser.add_argument("--keep", action="store_true", help="keep logs, blocks and maps")
    parser.add_argument("--reuse", action="store_true", help="take logs that an earlier --keep left")
    parser.add_argument("--report-only", action="store_true", help="exit code 0 whatever is missed")
    arguments = parser.parse_args()
    everything, bad = {}, False
    for site_file in arguments.sites:
        name, f = measure_site(arguments, site_file)
        everything[name] = f
        missed = misses(f)
        bad = bad or bool(missed)
        print(f"\n**{name}**: repeated drives {100 * f.get('repeat', float('nan')):.1f} % per panel, "
              f"{100 * f.get('repeat_half_metre', float('nan')):.1f} % per half metre; sign of {f['clear_changes']} clear "
              f"changes right in {100 * f['sign']:.1f} %; missed: {', '.join(missed) or '–'}\n")
        print("| date | panels | shift m | posts against the first date, rms mm | residual mm | plant area, ratio, RRMSE, slope | "
              "truth in 95 % interval | leaf area, ratio, RRMSE, worst panel m² | truth in 95 % interval |")
        print("|---|---|---|---|---|---|---|---|---|")
        for date, x in f["dates"].items():
            print(f"| {date} | {x['panels']} | {x['shift_m']:.1f} | {1e3 * x['posts_m']:.0f} | {1e3 * x['residual_m']:.0f} "
                  f"| {x['total']:.3f}, {100 * x['rrmse']:.1f} %, {x['slope']:.2f} | {100 * x['plant_in_interval']:.0f} % "
                  f"| {x['leaf_total']:.3f}, {100 * x['leaf_rrmse']:.1f} %, "
                  f"{x['leaf_worst_m2']:.2f} | {100 * x['in_interval']:.0f} % |", flush=True)
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(everything, file, indent=1, default=float)
    sys.exit(1 if bad and not arguments.report_only else 0)


if __name__ == "__main__":
    main()
