#!/usr/bin/env python3
"""What porosity and exposed leaf share are in error by their formulas alone (docs/descriptors.md, "Errors").

    tests/accuracy/descriptor_formulas.py

Random rhombic leaves with spherical angles along 24 m of row, unevenly dense along, across and upwards. True values
come from level lines every 2 cm; the others from the exact leaf area in the faces of voxels, without a lidar: with
exp(−L) of single faces, with exp(−L) of means over 3 × 3 faces, and as rayfield does. Prints a Markdown table. Needs
python3-numpy.
"""
import numpy as np

LENGTH_M, TOP_M, LINE_M, HALF_METRE = 24.0, 2.4, 0.02, 0.5


def leaves(random, area_per_m, kind, smallest_m2, largest_m2):
    """Areas, centres (along, up) and half diagonals, seen from the side, of the leaves."""
    count = int(area_per_m * LENGTH_M / ((smallest_m2 + largest_m2) / 2))
    area, along = random.uniform(smallest_m2, largest_m2, count), random.uniform(0, LENGTH_M, count)
    up = 0.9 + random.beta(1.6, 1.9, count) if kind == "wall" else 0.6 + 1.35 * random.beta(2, 2, count)
    kept = random.uniform(0, 1, count) < 0.75 + 0.25 * np.sin(2 * np.pi * along / 6)
    area, along, up = area[kept], along[kept], up[kept]
    normal, other = random.normal(size=(len(area), 3)), random.normal(size=(len(area), 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    first = other - (other * normal).sum(1)[:, None] * normal
    first /= np.linalg.norm(first, axis=1)[:, None]
    half = 0.5 * np.sqrt(2 * area)[:, None]
    return area, np.stack([along, up], 1), (1.05 * half * first)[:, [0, 2]], (half / 1.05 * np.cross(normal, first))[:, [0, 2]]


def meetings(centres, a, b):
    """Leaves on each line."""
    counts = np.zeros((round(LENGTH_M / LINE_M), round(TOP_M / LINE_M)), int)
    det = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    for i in np.flatnonzero(np.abs(det) > 1e-9):
        reach = np.abs(a[i]) + np.abs(b[i])
        low = np.maximum(((centres[i] - reach) / LINE_M - 0.5).astype(int), 0)
        high = np.minimum(((centres[i] + reach) / LINE_M + 1).astype(int), counts.shape)
        x, z = np.meshgrid((np.arange(low[0], high[0]) + 0.5) * LINE_M - centres[i, 0],
                           (np.arange(low[1], high[1]) + 0.5) * LINE_M - centres[i, 1], indexing="ij")
        p, q = (x * b[i, 1] - z * b[i, 0]) / det[i], (z * a[i, 0] - x * a[i, 1]) / det[i]
        counts[low[0]:high[0], low[1]:high[1]] += np.abs(p) + np.abs(q) < 1
    return counts


def pieces(area, centres, a, b, side=16):
    """Leaves as points with areas."""
    u, v = np.meshgrid((np.arange(side) + 0.5) / side * 2 - 1, (np.arange(side) + 0.5) / side * 2 - 1)
    inside = np.abs(u) + np.abs(v) <= 1
    points = centres[:, None] + u[inside][None, :, None] * a[:, None] + v[inside][None, :, None] * b[:, None]
    return points.reshape(-1, 2), np.repeat(area / inside.sum(), inside.sum())


def outline(points, weights):
    """Lower and upper edge of each half metre."""
    edges = []
    for k in range(round(LENGTH_M / HALF_METRE)):
        inside = (points[:, 0] >= k * HALF_METRE) & (points[:, 0] < (k + 1) * HALF_METRE)
        order = np.argsort(points[inside, 1])
        up, below = points[inside, 1][order], np.cumsum(weights[inside][order])
        edges.append((np.interp(0.03 * below[-1], below, up), np.interp(0.97 * below[-1], below, up)))
    return np.array(edges)


def described(contacts, share, leaf_m2, face_m2, reach, finite):
    """Porosity and exposed share from L of faces, `share` of which lies in the outline."""
    def around(values):
        padded = np.pad(values, reach)
        return sum(padded[i:i + values.shape[0], j:j + values.shape[1]]
                   for i in range(2 * reach + 1) for j in range(2 * reach + 1))
    inside = share > 0
    faces = around(share)[inside]
    mean, weight = around(share * contacts)[inside] / faces, share[inside]
    g = np.clip(0.5 * leaf_m2 / (faces * face_m2), 1e-9, 0.5) if finite else np.full_like(mean, 1e-9)
    none = np.exp(mean / g * np.log1p(-g))
    one = mean * np.exp((mean / g - 1) * np.log1p(-g))
    return (weight * none).sum() / weight.sum(), (weight * (2 - 2 * none - one)).sum() / (weight * mean).sum()


def main():
    random = np.random.default_rng(3)
    print("| canopy | leaves, m²/m | leaf layers: true, formula | porosity: true | faces, exp | 3 × 3, exp | as rayfield | exposed: true | faces, exp | 3 × 3, exp | as rayfield |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for kind, density, smallest, largest, voxel in (("wall", 0.3, 0.0035, 0.010, 0.07), ("wall", 1.5, 0.0035, 0.010, 0.07),
                                                    ("wall", 3, 0.0035, 0.010, 0.07), ("wall", 5, 0.0035, 0.010, 0.07),
                                                    ("wall, small leaves", 4, 0.0015, 0.0025, 0.06),
                                                    ("sprawl", 1.5, 0.005, 0.011, 0.075), ("sprawl", 4, 0.005, 0.011, 0.075)):
        area, centres, a, b = leaves(random, density, kind.split(",")[0], smallest, largest)
        points, weights = pieces(area, centres, a, b)
        edges = outline(points, weights)
        counts = meetings(centres, a, b)
        low, high = edges[np.minimum(np.arange(counts.shape[0]) * LINE_M / HALF_METRE, len(edges) - 0.5).astype(int)].T
        up = (np.arange(counts.shape[1]) + 0.5) * LINE_M
        met = counts[(up[None, :] > low[:, None]) & (up[None, :] < high[:, None])]

        shape = int(LENGTH_M / voxel), int(TOP_M / voxel)
        contacts = 0.5 / voxel ** 2 * np.histogram2d(*points.T, bins=shape, weights=weights,
                                                     range=[[0, shape[0] * voxel], [0, shape[1] * voxel]])[0]
        middle = (np.arange(shape[0]) + 0.5) * voxel
        low, high = edges[np.minimum(middle / HALF_METRE, len(edges) - 0.5).astype(int)].T
        layer = np.arange(shape[1]) * voxel
        share = np.clip((np.minimum(high[:, None], layer + voxel) - np.maximum(low[:, None], layer)) / voxel, 0, 1)
        leaf = np.average(area, weights=area)
        ways = [described(contacts, share, leaf, voxel ** 2, *way) for way in ((0, False), (1, False), (1, True))]
        print(f"| {kind} | {weights.sum() / LENGTH_M:.2f} | {met.mean():.3f}, {(share * contacts).sum() / share.sum():.3f} "
              f"| {(met == 0).mean():.3f} | " + " | ".join(f"{w[0]:.3f}" for w in ways)
              + f" | {np.minimum(met, 2).sum() / met.sum():.3f} | " + " | ".join(f"{w[1]:.3f}" for w in ways) + " |")


if __name__ == "__main__":
    main()
