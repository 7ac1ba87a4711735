#!/usr/bin/env python3
"""How much leaf area further drives past bare vines read against the dormant scan: 0 in truth, and what is noise of it.

    tests/accuracy/bare_drives.py RAYFIELD OUT sim/sites/leaf_area/leaf_{vsp,north,sprawl,orchard}.toml [--drives 10]

Each site is simulated without leaves, once as the dormant scan and --drives times more, with other seeds, speeds and
orders of the lanes, and measured by accuracy.py (true poses). Errors of panels are taken apart as
drive + panel + rest: the rest is a drive's own noise; the panels' part, common to all drives, is the dormant scan's
noise if it is as large as that, and the wood's if it is larger; the drives' part is a bias of whole drives. Reports
only: the exit code is 0.
"""
import argparse
import datetime
import json
import os
import subprocess
import sys

import numpy as np

SPEEDS = (1.4, 1.5, 1.2, 1.6, 1.3, 1.5, 1.4, 1.8, 1.1, 1.5, 1.6)
ORDERS = ("skip", "reverse", "sequential")


def write_site(source, out, drives):
    """The site with `drives` + 1 leafless dates a few days apart, in the leafless months of its hemisphere."""
    with open(source) as file:
        head = file.read().split("[[date]]")[0]
    south = "latitude_deg = -" in head
    first, step = (datetime.date(2021, 6, 10), 7) if south else (datetime.date(2021, 1, 5), 5)
    path = f"{out}/{os.path.basename(source).replace('leaf_', 'bare_')}"
    with open(path, "w") as file:
        file.write(head)
        for i in range(drives + 1):
            file.write(f'\n[[date]]\ndate = "{first + datetime.timedelta(days=step * i)}"\nleaf_fraction = 0\n'
                       f'seed = {9000 + 37 * i}\norder = "{ORDERS[i % 3]}"\nspeed_m_s = {SPEEDS[i % len(SPEEDS)]}\n')
    return path


def figures_of(scans):
    leaves = [f["leaf"] for scan_id, f in scans.items() if "leaf" in f and f["leaf"]["wood"] != scan_id]
    error, se, half = (np.array([leaf[key] for leaf in leaves]) for key in ("errors_m2", "ses_m2", "halves_m2"))
    drives, panels = error.shape
    of_drives, of_panels, mean = error.mean(1), error.mean(0), error.mean()
    rest = error - of_drives[:, None] - of_panels[None, :] + mean
    variance = (rest ** 2).sum() / ((drives - 1) * (panels - 1))
    large = np.abs(error) > 0.1
    return {"drives": drives, "panels": panels, "mean": mean, "rms": np.sqrt((error ** 2).mean()), "noise": np.sqrt(variance),
            "panel": np.sqrt(max(0, of_panels.var(ddof=1) - variance / drives)),
            "drive": np.sqrt(max(0, of_drives.var(ddof=1) - variance / panels)), "se": se.mean(), "half": half.mean(),
            "worst": np.abs(error).max(), "large": int(large.sum()), "large_drives": int(large.any(1).sum()),
            "beyond_se": float((np.abs(error) > 1.96 * se).mean()), "beyond": int((np.abs(error) > half + 1e-12).sum())}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rayfield")
    parser.add_argument("out")
    parser.add_argument("sites", nargs="+")
    parser.add_argument("--drives", type=int, default=10)
    arguments = parser.parse_args()
    if arguments.drives < 2:
        sys.exit("--drives: at least 2")
    os.makedirs(arguments.out, exist_ok=True)
    sites = [write_site(site, arguments.out, arguments.drives) for site in arguments.sites]
    figures = f"{arguments.out}/bare.json"
    # accuracy.py's exit code says that a target is missed, which is the question here.
    subprocess.run([sys.executable, os.path.join(os.path.dirname(os.path.abspath(__file__)), "accuracy.py"),
                    arguments.rayfield, arguments.out, *sites, "--json", figures], stdout=subprocess.DEVNULL)
    with open(figures) as file:
        everything = json.load(file)
    print("| site | drives × panels | mean | drive's noise | panels' part | drives' part | rms | se stated | beyond 1.96 se "
          "| half interval | beyond it | worst | panels over 0.1 m², in drives |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    for name, scans in everything.items():
        f = figures_of(scans)
        print(f"| {name} | {f['drives']} × {f['panels']} | {f['mean']:+.3f} | {f['noise']:.3f} | {f['panel']:.3f} | {f['drive']:.3f} "
              f"| {f['rms']:.3f} | {f['se']:.3f} | {100 * f['beyond_se']:.0f} % | {f['half']:.2f} | {f['beyond']} | {f['worst']:.2f} "
              f"| {f['large']}, {f['large_drives']} |")


if __name__ == "__main__":
    main()
