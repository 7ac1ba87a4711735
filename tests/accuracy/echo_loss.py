#!/usr/bin/env python3
"""The tables of libdensity/echoes/echo_loss_table.h: what of the leaves' share of a wide beam comes back as echoes.

    tests/accuracy/echo_loss.py [--beams 100000] [--seed 1] > libdensity/echoes/echo_loss_table.h

Monte Carlo: beams of SUB_RAYS parallel sub-rays, of equal energy and evenly over a disc, go through square leaves of
side 1 at random places and with random normals (a Poisson process). What comes back of a sub-ray that ends on a leaf
is 1 - ANGLE (1 - cos i), i its angle of incidence, over that of the mean cosine at which rays meet leaves, 2/3. A
stretch of the range resolution b from an end of a sub-ray on, of which the detection share t of a full echo comes
back, makes the echo, the first such stretch; the echo has their strength w, in full echoes, and their mean range.
Leaves in front of it from which less came back returned nothing.
Counted as the estimator counts: hits w; path up to the echo, and behind it (1 - w) * BEHIND * b. The table holds
hits / (path * true hits per path of thin rays), by diameter over side, optical path of a range resolution (how many
leaves add up to one echo), t, and optical path before. Of the range resolution itself, beside its optical path, little
depends (--spread prints it).
A second table holds the mean w of the echoes, in canopy as dense as it is around echoes (SHARE_DENSITY).
"""
import argparse
import itertools

import numpy as np

SUB_RAYS = 61
BEHIND = 0.8
DIAMETERS = [0, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.3]      # over the side of a leaf; 0: nothing is lost
SHARES = [0.05, 0.10, 0.15, 0.20, 0.25, 0.30, 0.35, 0.40, 0.45, 0.50]
DEPTHS = [0, 0.5, 1.0, 1.5, 2.0, 3.0]                      # optical path: edges of the bins
RESOLUTION = 1.8                                           # range resolution over the side of a leaf
RESOLUTION_PATHS = [0.04, 0.15, 0.35, 0.7]                 # its optical path; above, it blurs the bins of depth
ANGLE = 0.35                                               # between no dependence on the angle and 0.7
SHARE_DENSITY = 0.47  # hits per side: so that seven simulated scans give the right full echo in the mean (docs/beams.md)


def disc():
    i = np.arange(SUB_RAYS) + 0.5
    r, a = np.sqrt(i / SUB_RAYS) / 2, i * np.pi * (3 - np.sqrt(5))
    return r * np.cos(a), r * np.sin(a)


def unit_vectors(rng, shape):
    z, a = rng.uniform(-1, 1, shape), rng.uniform(0, 2 * np.pi, shape)
    s = np.sqrt(1 - z * z)
    return np.stack([s * np.cos(a), s * np.sin(a), z], -1)


def ends_of(rng, beams, diameter, rate, depth):
    """Where the sub-rays end, (beams, SUB_RAYS), inf for those that pass, and what comes back of them."""
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
    ends, back = np.full((beams, SUB_RAYS), np.inf), np.zeros((beams, SUB_RAYS))
    for k in range(most):
        n, c = normal[:, k], place[:, k]
        dx, dy = x - c[:, :1], y - c[:, 1:2]
        dz = -(n[:, :1] * dx + n[:, 1:2] * dy) / n[:, 2:3]
        on = there[:, k, None]
        for axis in (u[:, k], v[:, k]):
            on = on & (np.abs(axis[:, :1] * dx + axis[:, 1:2] * dy + axis[:, 2:3] * dz) <= 0.5)
        z = c[:, 2:3] + dz
        on = on & (z >= 0) & (z < np.minimum(ends, depth))
        ends = np.where(on, z, ends)
        back = np.where(on, (1 - ANGLE * (1 - np.abs(n[:, 2:3]))) / (1 - ANGLE / 3), back)
    order = np.argsort(ends, axis=1)
    return np.take_along_axis(ends, order, 1), np.take_along_axis(back, order, 1)


def spread_over(edges, start, stop):
    """Lengths of start ... stop (arrays) between the edges, (bins,)."""
    clipped = np.clip(stop[:, None], edges[:-1], edges[1:]) - np.clip(start[:, None], edges[:-1], edges[1:])
    return clipped.sum(axis=0)


def echoes(rng, beams, diameter, rate, resolution, depth):
    """For some beams at a time and every share: (index of the share, whether there is an echo, w, its mean range)."""
    for begin in range(0, beams, 400):
        n = min(400, beams - begin)
        z, back = ends_of(rng, n, diameter, rate, depth)
        met = np.isfinite(z)
        place = np.where(met, z, 0)
        after = np.arange(SUB_RAYS) >= np.arange(SUB_RAYS)[:, None]
        inside = (z[:, None, :] <= z[:, :, None] + resolution) & after & met[:, :, None]
        held = (back[:, None, :] * inside).sum(axis=2)
        mean = ((place * back)[:, None, :] * inside).sum(axis=2) / np.maximum(held, 1e-9)
        dither = rng.uniform(-0.5, 0.5, (n, 1))
        for s, share in enumerate(SHARES):
            makes = met & (held + dither >= share * SUB_RAYS)
            first = makes.argmax(axis=1)
            any_echo = makes[np.arange(n), first]
            yield s, any_echo, held[np.arange(n), first] / SUB_RAYS, mean[np.arange(n), first]


def mean_shares(rng, beams, diameter):
    """Mean w by share."""
    rate, resolution = SHARE_DENSITY, RESOLUTION
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
    parser.add_argument("--spread", action="store_true", help="how much the range resolution counts, instead of the table")
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    if options.spread:
        with np.printoptions(precision=3, suppress=True, linewidth=150):
            for diameter, path, resolution in itertools.product((0.3, 0.6), RESOLUTION_PATHS[1:], (1.0, RESOLUTION, 3.0)):
                hits, optical = returned(rng, options.beams, diameter, path / resolution, resolution)
                print(f"diameter {diameter}, optical path {path} of a resolution of {resolution} sides:\n"
                      f"{(hits / optical)[1::2]}")
        return
    table = np.ones((len(DIAMETERS), len(RESOLUTION_PATHS), len(SHARES), len(DEPTHS) - 1))
    for d, n in np.ndindex(table.shape[:2]):
        if d > 0:
            hits, optical = returned(rng, options.beams, DIAMETERS[d], RESOLUTION_PATHS[n] / RESOLUTION, RESOLUTION)
            table[d, n] = hits / optical
    shares = [np.ones(len(SHARES))] + [mean_shares(rng, options.beams // 4, diameter) for diameter in DIAMETERS[1:]]
    numbers = lambda xs: ", ".join(f"{float(x)}" for x in xs)
    rows = lambda plane, margin: (",\n" + margin).join("{" + ", ".join(f"{v:.3f}" for v in row) + "}" for row in plane)
    print(f"#pragma once\n\n#include <array>\n\n// Made by tests/accuracy/echo_loss.py --beams {options.beams}, which says how.\n"
          "namespace rayfield::density::echo_loss_table {\n")
    print(f"inline constexpr std::array kDiameters{{{numbers(DIAMETERS)}}};  ///< over the side of a leaf")
    print(f"inline constexpr std::array kResolutionPaths{{{numbers(RESOLUTION_PATHS)}}};  ///< optical, of a range resolution")
    print(f"inline constexpr std::array kShares{{{numbers(SHARES)}}};  ///< detection shares")
    mids = [(a + b) / 2 for a, b in zip(DEPTHS, DEPTHS[1:])]
    print(f"inline constexpr std::array kDepths{{{numbers(mids)}}};  ///< optical path before")
    print("/// [diameter][path of a resolution][share][depth]: echoes' strengths per optical path.")
    print("inline constexpr double kReturned" + "".join(f"[{size}]" for size in table.shape) + " = {")
    for cube in table:
        print("    {" + ",\n     ".join("{" + rows(plane, "      ") + "}" for plane in cube) + "},")
    print("};")
    print("/// [diameter][share]: mean strength of an echo.")
    print(f"inline constexpr double kMeanShare[{len(DIAMETERS)}][{len(SHARES)}] = {{")
    print("    " + rows(shares, "    ") + ",")
    print("};\n\n}  // namespace rayfield::density::echo_loss_table")


if __name__ == "__main__":
    main()
