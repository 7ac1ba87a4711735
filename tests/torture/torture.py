#!/usr/bin/env python3
"""Attacks the program and its stores for some minutes, and counts what it finds.

    tests/torture/torture.py PROGRAM FOLDER [--minutes 10] [--seed N] [--only KIND...]

PROGRAM: rayfield; FOLDER: is made, and deleted where nothing was found. Every kind of attack has the same time but
`inputs`, which goes through a list. What the machine does not permit (mounting, strace) is left out and said. Prints a
table: runs, attacks that really happened; lost, what had been promised and is gone; wrong, another result or exit code
than there should be, or damage that nobody noticed; crashed, an exit code that is not documented; unclear, not exactly
one line for an error. Exit code 1 where anything was found. Needs Python, and for all of it strace, mkfs, the right to
mount, and store_damage (tests/fault) beside the program.
"""
import argparse
import pathlib
import shutil
import sys
import time

import damage
import failing
import hostile
import limits
import writers
from lab import Lab

KINDS = {"kills": writers.kills, "kills at calls": failing.kills_at_calls, "signals": writers.signals,
         "system calls": failing.errors, "crowds": writers.crowds, "power cuts": limits.power_cuts,
         "full disks": limits.full_disks, "resources": limits.resources, "damage": damage.damage, "flips": damage.flips,
         "resealed": damage.resealed, "inputs": hostile.inputs}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="+", choices=KINDS, default=list(KINDS))
    options = parser.parse_args()
    if options.folder.exists():
        parser.error(f"{options.folder} is there already")
    lab = Lab(options.program, options.folder, options.seed)
    share = 60 * options.minutes / len(options.only)
    print(f"seed {options.seed}\n\n| attack | runs | lost | wrong | crashed | unclear | seconds |")
    print("|---|---|---|---|---|---|---|", flush=True)
    notes, findings = [], 0
    for kind in options.only:
        begun = time.monotonic()
        tally = KINDS[kind](lab, time.monotonic() + share)
        seconds = time.monotonic() - begun
        counts = " | ".join(str(n) for n in (tally.runs, tally.lost, tally.wrong, tally.crashed, tally.unclear))
        print(f"| {kind} | {'left out: ' + tally.skipped + ' | | | |' if tally.skipped else counts} | {seconds:.0f} |",
              flush=True)
        notes += [f"{kind}: {note}" for note in tally.notes]
        findings += tally.findings()
    if notes:
        print("\n" + "\n".join(notes))
    if findings == 0:
        shutil.rmtree(options.folder)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
