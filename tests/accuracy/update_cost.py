#!/usr/bin/env python3
"""What an update costs as dates pile up in a store: processor time and peak memory of `rayfield update`, date by date.

    tests/accuracy/update_cost.py build/release/cli/rayfield OUT [--dates 24] [--logs]

Simulates a small block with that many monthly dates (ray clouds; with --logs raw logs), updates a store with one after
the other, maps included, and once more with the last, where nothing is new. Dates differ in leaves and so in work: the
last date is compared with itself as the second date of a store, in turns and --repeats times, the cheapest of each, as
other work on the machine only adds. Prints a table; exit code 1 where a target is missed (--report-only: 0).
"""
import argparse
import datetime
import os
import shutil
import subprocess
import sys

GROWTH = 0.10           # of an update in the full store, against one in a store of two dates
NOTHING_NEW_S = 2.0     # elapsed

SITE = """[site]
name = "update_cost"
latitude_deg = -37.72
longitude_deg = 145.41
height_m = 140
seed = 1207

[terrain]
slope_percent = 5
slope_azimuth_deg = 310
relief_m = 0.3
relief_wavelength_m = 26

[rows]
count = 2
length_m = 20
spacing_m = 2.6
azimuth_deg = 41
panel_length_m = 4
vine_spacing_m = 1.6

[canopy]
leaf_area_m2_per_m = 2.5
vigour_variation = 0.4
"""
LEAF_FRACTION = (0, 0, 0, 0.1, 0.4, 0.7, 0.9, 1, 1, 1, 0.8, 0.5)  # by month, from June


def write_site(path, count):
    """A site with a date a month; returns the dates."""
    dates = [str(datetime.date(2018, 6, 5) + datetime.timedelta(days=int(30.4 * i))) for i in range(count)]
    with open(path, "w") as file:
        file.write(SITE)
        for i, date in enumerate(dates):
            file.write(f'\n[[date]]\ndate = "{date}"\nleaf_fraction = {LEAF_FRACTION[i % 12]}\nspeed_m_s = 1.6\n'
                       f'seed = {i + 1}\norder = "{("sequential", "reverse")[i % 2]}"\n')
    return dates


def measured(*command):
    """Runs a command: (processor seconds, elapsed seconds, peak resident MB) of that process alone."""
    started = datetime.datetime.now()
    process = subprocess.Popen([str(c) for c in command])
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {process.returncode}")
    elapsed = (datetime.datetime.now() - started).total_seconds()
    return usage.ru_utime + usage.ru_stime, elapsed, usage.ru_maxrss / 1024


class Blocks:
    def __init__(self, arguments):
        self.rayfield, self.out, self.logs = arguments.rayfield, arguments.out, arguments.logs

    def update(self, store, date):
        scan = f"{self.out}/logs/{date}"
        data = [f"{scan}/scan.bag", "--rig", f"{scan}/rig.toml"] if self.logs else [f"{scan}/rays.ply"]
        return measured(self.rayfield, "update", f"{self.out}/{store}", *data, "--date", date, "--crs", "EPSG:7855",
                        "-o", f"{self.out}/{store}_maps", "-q")

    def copy(self, store, to):
        for folder in ("", "_maps"):
            self.remove(to + folder)
            shutil.copytree(f"{self.out}/{store}{folder}", f"{self.out}/{to}{folder}")

    def remove(self, *folders):
        for folder in folders:
            shutil.rmtree(f"{self.out}/{folder}", ignore_errors=True)

    def last_of_many_and_of_two(self, first, last, repeats):
        """The cheapest update of "block" with the last date, and of a store that holds the first alone."""
        self.remove("first", "first_maps")
        self.update("first", first)
        costs = {"block": [], "first": []}
        for _ in range(repeats):
            for store in costs:
                os.makedirs(f"{self.out}/copy", exist_ok=True)
                self.copy(store, f"copy/{store}")
                costs[store].append(self.update(f"copy/{store}", last))
        return [tuple(min(c) for c in zip(*costs[store])) for store in ("block", "first")]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rayfield")
    parser.add_argument("out")
    parser.add_argument("--dates", type=int, default=24)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--logs", action="store_true", help="raw logs instead of ray clouds")
    parser.add_argument("--keep", action="store_true", help="take simulated dates that are there, and leave them")
    parser.add_argument("--report-only", action="store_true", help="exit code 0 whatever is missed")
    arguments = parser.parse_args()
    if arguments.dates < 3:
        sys.exit("--dates: at least 3")
    blocks = Blocks(arguments)
    os.makedirs(blocks.out, exist_ok=True)
    dates = write_site(f"{blocks.out}/update_cost.toml", arguments.dates)
    wanted = [d for d in dates if not os.path.isdir(f"{blocks.out}/logs/{d}")]
    if wanted:
        subprocess.run([arguments.rayfield, "simulate", f"{blocks.out}/update_cost.toml", "-o", f"{blocks.out}/logs", "-q",
                        "--no-rays" if arguments.logs else "--no-log",
                        *(word for date in wanted for word in ("--date", date))], check=True)
    blocks.remove("block", "block_maps")

    print("| update | date | processor s | elapsed s | peak MB |\n|---|---|---|---|---|")
    for i, date in enumerate(dates[:-1]):
        cost = blocks.update("block", date)
        print(f"| {i + 1} | {date} | {cost[0]:.2f} | {cost[1]:.2f} | {cost[2]:.0f} |", flush=True)
    of_many, of_two = blocks.last_of_many_and_of_two(dates[0], dates[-1], arguments.repeats)
    nothing = [blocks.update("copy/block", dates[-1]) for _ in range(arguments.repeats)]
    nothing = tuple(min(n) for n in zip(*nothing))
    for label, cost in ((str(len(dates)), of_many), ("nothing new", nothing), ("2, of a store of two", of_two)):
        print(f"| {label} | {dates[-1]} | {cost[0]:.2f} | {cost[1]:.2f} | {cost[2]:.0f} |")
    missed = []
    print()
    for name, now, then in (("time", of_many[0], of_two[0]), ("memory", of_many[2], of_two[2])):
        print(f"{name} of update {len(dates)} against that in a store of two: {100 * (now / then - 1):+.1f} %")
        if now > (1 + GROWTH) * then:
            missed.append(name)
    if nothing[1] >= NOTHING_NEW_S:
        missed.append("nothing new")
    print(f"missed: {', '.join(missed) or '–'}")
    if not arguments.keep:
        blocks.remove("logs", "block", "block_maps", "first", "first_maps", "copy")
    sys.exit(1 if missed and not arguments.report_only else 0)


if __name__ == "__main__":
    main()
