#!/usr/bin/env python3
"""The tables of libdensity/echoes/echo_loss_table.h: what of the leaves' share of a wide beam comes back as echoes.

    tests/accuracy/echo_loss.py [--beams 100000] [--seed 1] > libdensity/echoes/echo_loss_table.h

Monte Carlo: beams of SUB_RAYS parallel sub-rays, of equal energy and evenly over a disc, go through square leaves of
side 1 at random places and with random normals (a Poisson process). A stretch of the range resolution b from an end
of a sub-ray on that holds the detection share t of the sub-rays makes the echo, the first such stretch; the echo has
their share w of the beam and their mean range. Leaves in front of it that took less than t returned nothing.
Counted as the estimator counts: hits w; path up to the echo, and behind it (1 - w) * BEHIND * b. The table holds
hits / (path * true hits per path of thin rays), by diameter over side, t, and optical path before, over two densities
and two range resolutions taken together (--spread prints them one by one).
A second table holds the mean w of the echoes, in canopy as dense as it is around echoes (SHARE_CASE).
"""
import argparse

import numpy as np

SUB_RAYS = 61
BEHIND = 0.8
DIAMETERS = [0, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.3]      # over the side of a leaf; 0: nothing is lost
SHARES = [0.05, 0.10, 0.15, 0.20, 0.25, 0.30, 0.35, 0.40, 0.45, 0.50]
DEPTHS = [0, 0.5, 1.0, 1.5, 2.0, 3.0]                      # optical path: edges of the bins
CASES = [(0.15, 1.5), (0.15, 2.5), (0.35, 1.5), (0.35, 2.5)]  # hits per side of a leaf; range resolution over side
SHARE_CASE = (0.47, 1.8)  # its density: so that seven simulated scans give the right full echo in the mean (docs/beams.md)


def disc():
    i = np.arange(SUB_RAYS) + 0.5
    r, a = np.sqrt(i / SUB_RAYS) / 2, i * np.pi * (3 - np.sqrt(5))
    return r * np.cos(a), r * np.sin(a)


def unit_vectors(rng, shape):
    z, a = rng.uniform(-1, 1, shape), rng.uniform(0, 2 * np.pi, shape)
    s = np.sqrt(1 - z * z)
    return np.stack([s * np.cos(a), s * np.sin(a), z], -1)


def ends_of(rng, beams, diameter, rate, depth):
    """Where the sub-rays end, (beams, SUB_RAYS), inf for those that pass."""
    x0, y0 = disc()
    turn = rng.uniform(0, 2 * np.pi, (beams, 1))
    x = diameter * (x0 * np.cos(turn) - y0 * np.sin(turn))
    y = diameter * (x0 * np.sin(turn) + y0 * np.cos(turn))
    reach = diameter / 2 + np.sqrt(0.5)
    # A leaf of area 1 with any normal shows 1/2 of itself in the mean. Leaves may stand up to half a diagonal outside.
    low, high = -np.sqrt(0.5), depth + np.sqrt(0.5)
    mean = 2 * rate * (2 * reach) ** 2 * (high - low)
    counts = rng.poisson(mean, beams)
    most = counts.max()
    there = np.arange(most) < counts[:, None]
    place = np.stack([rng.uniform(-reach, reach, (beams, most)), rng.uniform(-reach, reach, (beams, most)),
                      rng.uniform(low, high, (beams, most))], -1)
    normal = unit_vectors(rng, (beams, most))
    other = np.cross(normal, unit_vectors(rng, (beams, most)))
    u = other / np.linalg.norm(other, axis=-1, keepdims=True)
    v = np.cross(normal, u)
    ends = np.full((beams, SUB_RAYS), np.inf)
    for k in range(most):
        n, c = normal[:, k], place[:, k]
        dx, dy = x - c[:, :1], y - c[:, 1:2]
        dz = -(n[:, :1] * dx + n[:, 1:2] * dy) / n[:, 2:3]
        on = there[:, k, None]
        for axis in (u[:, k], v[:, k]):
            on = on & (np.abs(axis[:, :1] * dx + axis[:, 1:2] * dy + axis[:, 2:3] * dz) <= 0.5)
        z = c[:, 2:3] + dz
        ends = np.where(on & (z >= 0), np.minimum(ends, z), ends)
    ends[ends > depth] = np.inf
    return np.sort(ends, axis=1)


def spread_over(edges, start, stop):
    """Lengths of start ... stop (arrays) between the edges, (bins,)."""
    clipped = np.clip(stop[:, None], edges[:-1], edges[1:]) - np.clip(start[:, None], edges[:-1], edges[1:])
    return clipped.sum(axis=0)


def echoes(rng, beams, diameter, rate, resolution, depth):
    """For some beams at a time and every share: (index of the share, whether there is an echo, w, its mean range)."""
    for begin in range(0, beams, 400):
        n = min(400, beams - begin)
        z = ends_of(rng, n, diameter, rate, depth)
        met = np.isfinite(z)
        inside = (z[:, None, :] <= z[:, :, None] + resolution) & (np.arange(SUB_RAYS) >= np.arange(SUB_RAYS)[:, None])
        held = np.where(met, inside.sum(axis=2), 0)
        mean = np.where(met, (np.where(met, z, 0)[:, None, :] * inside).sum(axis=2) / np.maximum(held, 1), 0)
        dither = rng.uniform(-0.5, 0.5, (n, 1))
        for s, share in enumerate(SHARES):
            makes = met & (held + dither >= share * SUB_RAYS)
            first = makes.argmax(axis=1)
            any_echo = makes[np.arange(n), first]
            yield s, any_echo, held[np.arange(n), first] / SUB_RAYS, mean[np.arange(n), first]


def mean_shares(rng, beams, diameter):
    """Mean w by share."""
    rate, resolution = SHARE_CASE
    sums, counts = np.zeros(len(SHARES)), np.zeros(len(SHARES))
    for s, any_echo, w, _ in echoes(rng, beams, diameter, rate, resolution, 2.5 / rate + 2 * resolution):
        sums[s] += w[any_echo].sum()
        counts[s] += any_echo.sum()
    return sums / counts


def returned(rng, beams, diameter, rate, resolution):
    """Hits and optical path, each (shares, bins)."""
    edges = np.array(DEPTHS) / rate
    depth = edges[-1] + 2 * resolution
    hits, path = np.zeros((len(SHARES), len(DEPTHS) - 1)), np.zeros((len(SHARES), len(DEPTHS) - 1))
    for s, any_echo, w, mean in echoes(rng, beams, diameter, rate, resolution, depth):
        n = len(w)
        at = np.where(any_echo, mean, depth)
        path[s] += spread_over(edges, np.zeros(n), at)
        behind = np.where(any_echo, (1 - w) * BEHIND * resolution, 0)
        stretch = BEHIND * resolution
        for b in range(len(edges) - 1):  # evenly over the stretch behind
            overlap = np.clip(np.minimum(at + stretch, edges[b + 1]) - np.maximum(at, edges[b]), 0, None) / stretch
            path[s, b] += (behind * overlap).sum()
        bins = np.searchsorted(edges, at, side="right") - 1
        ok = any_echo & (bins < len(edges) - 1)
        np.add.at(hits[s], bins[ok], w[ok])
    return hits, rate * path


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--beams", type=int, default=100000, help="of each diameter and case")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--spread", action="store_true", help="the cases one by one, instead of the table")
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    table = np.ones((len(DIAMETERS), len(SHARES), len(DEPTHS) - 1))
    for d, diameter in enumerate(DIAMETERS[1:], 1):
        hits, path = np.moveaxis([returned(rng, options.beams, diameter, *case) for case in CASES], 1, 0)
        table[d] = hits.sum(axis=0) / path.sum(axis=0)
        if options.spread:
            with np.printoptions(precision=3, suppress=True, linewidth=150):
                for case, value in zip(CASES, hits / path):
                    print(f"diameter {diameter}, (hits per side, resolution) {case}:\n{value[1::2]}")
    if options.spread:
        return
    shares = [np.ones(len(SHARES))] + [mean_shares(rng, options.beams // 4, diameter) for diameter in DIAMETERS[1:]]
    numbers = lambda xs: ", ".join(f"{float(x)}" for x in xs)
    print(f"#pragma once\n\n#include <array>\n\n// Made by tests/accuracy/echo_loss.py --beams {options.beams}, which says how.\n"
          "namespace rayfield::density::echo_loss_table {\n")
    print(f"inline constexpr std::array kDiameters{{{numbers(DIAMETERS)}}};  ///< over the side of a leaf")
    print(f"inline constexpr std::array kShares{{{numbers(SHARES)}}};  ///< detection shares")
    mids = [(a + b) / 2 for a, b in zip(DEPTHS, DEPTHS[1:])]
    print(f"inline constexpr std::array kDepths{{{numbers(mids)}}};  ///< optical path before")
    print("/// [diameter][share][depth]: echoes' shares per optical path.")
    print(f"inline constexpr double kReturned[{len(DIAMETERS)}][{len(SHARES)}][{len(mids)}] = {{")
    for plane in table:
        print("    {" + ",\n     ".join("{" + ", ".join(f"{v:.3f}" for v in row) + "}" for row in plane) + "},")
    print("};")
    print("/// [diameter][share]: mean share of the beam in its echo.")
    print(f"inline constexpr double kMeanShare[{len(DIAMETERS)}][{len(SHARES)}] = {{")
    print(",\n".join("    {" + ", ".join(f"{v:.3f}" for v in row) + "}" for row in shares) + ",")
    print("};\n\n}  // namespace rayfield::density::echo_loss_table")


if __name__ == "__main__":
    main()
