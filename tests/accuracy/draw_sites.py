#!/usr/bin/env python3
"""Draws sites with real beams at random, one scan in full leaf each, for accuracy.py.

    tests/accuracy/draw_sites.py one|several COUNT SEED OUT [--prefix NAME] [--thin] [--all-rays]
                             [--returns first|strongest|last] [--season] [--fractions]

Two rows of 22 m of walls, sprawl or crowns: slope, azimuth, latitude, spacing, leaf area per metre, size and outline of
leaves, detection share, range resolution, angle dependence and scatter of echoes, and dark wood are drawn. `one`: spun
2-D scanners with beams of 8 mm + 2.5 mrad to 13.6 mm + 11.9 mrad. `several`: VLP-16-, Ouster-, Livox- and XT32-like
lidars in turn, reporting the first or the strongest echo; their clouds hold the downward beams without a return, as
`rayfield slam` keeps them. With --thin the same sites and seeds with beams without a width: what is wrong there is not
the beams'. With --all-rays clouds of one beam hold them, too; with --returns all lidars report that echo. With
--season each site has three rows and three dates for seasons.py, bare, with half of its leaves and with all, driven in
other orders and with the receiver off by another vector on each. With --fractions three of ten sites have half of their
leaves and one a fifth, in spring. The same SEED draws the same sites.
"""
import argparse
import os
import random

ONE_BEAM = [(0.008, 2.5), (0.0095, 3), (0.010, 5), (0.010, 7), (0.0136, 9), (0.0136, 11.9)]  # m at the exit, mrad
ORCHARD = """[structure]
post_height_m = 2.6
strainer_height_m = 2.6
post_diameter_m = 0.09
wire_heights_m = [1.0, 1.8, 2.5]
trunk_diameter_m = 0.06
cordon_diameter_m = 0
cane_length_m = 1.1
canes_per_m = 6"""


def between(rng, least, most):
    """Evenly by logarithm."""
    return least * (most / least) ** rng.random()


def canopy(rng, kind, several):
    area = between(rng, 0.6, 5.1) if several else between(rng, 0.7, 5.0)
    leaf = between(rng, 35, 110) if several else between(rng, 25, 120)
    extent = {"vsp": [("bottom_m", rng.uniform(0.6, 0.9)), ("top_m", rng.uniform(1.7, 2.1)), ("width_m", rng.uniform(0.35, 0.6))],
              "sprawl": [("bottom_m", 0.8), ("top_m", rng.uniform(1.7, 2.0)), ("width_m", rng.uniform(0.8, 1.2))],
              "crown": [("bottom_m", 0.7), ("top_m", 2.8), ("width_m", rng.uniform(1.0, 1.4))]}[kind]
    return ["[canopy]", f'kind = "{kind}"', *(f"{key} = {value:.2f}" for key, value in extent),
            f"leaf_area_m2_per_m = {area:.2f}", f"leaf_size_min_cm2 = {0.65 * leaf:.0f}",
            f"leaf_size_max_cm2 = {1.35 * leaf:.0f}", f'leaf_shape = "{rng.choice(["rhombus", "triangle", "lobed"])}"']


def several_beams(rng, number):
    returns = rng.choice(["first", "strongest"])
    lidar, beams = [
        ([("beam_diameter_m", 0.010), ("divergence_mrad", rng.uniform(2.5, 3.5)), ("range_noise_m", 0.02)],
         [("azimuth_steps", rng.choice([600, 720]))]),
        ([("beam_diameter_m", 0.005), ("divergence_mrad", rng.uniform(5, 6.5)), ("energy_profile", '"gaussian"'), ("range_noise_m", 0.015)],
         [("beams", 20), ("elevation_min_deg", -45), ("elevation_max_deg", 45), ("azimuth_steps", 512)]),
        ([("beam_diameter_m", 0.010), ("divergence_mrad", 0.52), ("divergence_z_mrad", rng.uniform(4, 5.5)), ("range_noise_m", 0.01)],
         [("beams", 18), ("elevation_min_deg", -28), ("elevation_max_deg", 28), ("azimuth_steps", 480)]),
        ([("beam_diameter_m", 0.012), ("divergence_mrad", rng.uniform(1.5, 3)), ("range_noise_m", 0.01)],
         [("beams", 31), ("elevation_min_deg", -16), ("elevation_max_deg", 15), ("azimuth_steps", 480)])][number % 4]
    return [("kind", '"multi_beam"'), ("max_range_m", 50), ("returns", f'"{returns}"'), *lidar], beams


def text(values):
    return [f"{key} = {value:.4g}" if isinstance(value, float) else f"{key} = {value}" for key, value in values]


def dates(rng, latitude, season, leaves):
    south = latitude < 0
    summer, spring = ("2020-01-15", "2020-11-10") if south else ("2020-07-15", "2020-05-10")
    full = [f'date = "{summer if leaves == 1 else spring}"', f"leaf_fraction = {leaves:.1f}",
            f"speed_m_s = {rng.uniform(1.0, 1.6):.2f}", f"seed = {rng.randrange(1000)}"]
    if not season:
        return ["[[date]]", *full, ""]
    lines = []
    for date, fraction in (("2019-08-05" if south else "2020-02-05", 0.0),
                           ("2019-11-10" if south else "2020-05-10", 0.5), (None, 1.0)):
        lines += ["[[date]]", *(full if date is None else
                                [f'date = "{date}"', f"leaf_fraction = {fraction}", f"speed_m_s = {rng.uniform(1.0, 1.6):.2f}",
                                 f"seed = {rng.randrange(1000)}"]),
                  f'order = "{rng.choice(["skip", "reverse", "sequential"])}"', "[[date.gps_jumps]]", "start_s = 0",
                  "duration_s = 100000", *(f"{axis}_m = {rng.uniform(-2.5, 2.5):.2f}" for axis in ("east", "north", "up"))]
    return [*lines, ""]


def site(rng, name, number, several, thin, all_rays, returns, season, leaves):
    kind = rng.choice(["vsp", "sprawl", "crown"] if several else ["vsp", "vsp", "sprawl"])
    spacing = rng.uniform(3.4, 4.2) if kind == "crown" else rng.uniform(2.4, 3.6)
    latitude = rng.uniform(-45, 50)
    lines = ["[site]", f'name = "{name}"', f"latitude_deg = {latitude:.3f}",
             f"longitude_deg = {rng.uniform(-120, 150):.3f}", f"height_m = {rng.uniform(10, 500):.0f}",
             f"seed = {rng.randrange(10**6)}", "[terrain]", f"slope_percent = {rng.uniform(0, 12):.1f}",
             f"slope_azimuth_deg = {rng.uniform(0, 360):.0f}", f"relief_m = {rng.uniform(0.1, 0.4):.2f}",
             "relief_wavelength_m = 35", "[rows]", f"count = {3 if season else 2}", "length_m = 22", f"spacing_m = {spacing:.2f}",
             f"azimuth_deg = {rng.uniform(0, 180):.0f}", "panel_length_m = 5.5",
             f"vine_spacing_m = {rng.uniform(1.0, 2.0):.2f}", *([ORCHARD] if kind == "crown" else [])]
    lines += canopy(rng, kind, several)
    if several:
        lidar, beams = several_beams(rng, number)
    else:
        diameter, divergence = rng.choice(ONE_BEAM)
        lidar, beams = [("beam_diameter_m", diameter), ("divergence_mrad", divergence)], []
    drawn = [("detection_share", rng.uniform(0.12, 0.40)), ("detection", '"returned_energy"'),
             ("range_resolution_m", rng.uniform(0.10, 0.30) if several else rng.uniform(0.08, 0.25)),
             ("echo_scatter", rng.choice([0, 0, 0.13, 0.26]))]
    if thin:
        lidar = [(key, 0 if key in ("beam_diameter_m", "divergence_mrad", "divergence_z_mrad") else value)
                 for key, value in lidar]
    if returns:
        lidar = [(key, value) for key, value in lidar if key != "returns"] + [("returns", f'"{returns}"')]
    if several or all_rays:
        lidar.append(("keeps_downward_misses", "true"))
    lines += ["[lidar]", *text(lidar + drawn), *(["[multi_beam]", *text(beams)] if beams else [])]
    lines += ["[reflectance]", f"angle_dependence = {rng.uniform(0, 1):.2f}"]
    if rng.random() < 2 / 3:
        lines += ["post = 0.55", "wood = 0.55", "wire = 0.55"]
    return "\n".join(lines + dates(rng, latitude, season, leaves))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("lidars", choices=["one", "several"])
    parser.add_argument("count", type=int)
    parser.add_argument("seed", type=int)
    parser.add_argument("out")
    parser.add_argument("--prefix", default="drawn")
    parser.add_argument("--thin", action="store_true")
    parser.add_argument("--all-rays", action="store_true")
    parser.add_argument("--returns", choices=["first", "strongest", "last"])
    parser.add_argument("--season", action="store_true")
    parser.add_argument("--fractions", action="store_true")
    arguments = parser.parse_args()
    os.makedirs(arguments.out, exist_ok=True)
    for number in range(arguments.count):
        rng = random.Random(f"{arguments.seed} {number}")  # so that fewer of them are the same
        name = f"{arguments.prefix}_{number:02d}"
        fraction = random.Random(f"{arguments.seed} {number} leaves").choice([1] * 6 + [0.5] * 3 + [0.2])
        with open(f"{arguments.out}/{name}.toml", "w") as file:
            file.write(site(rng, name, number, arguments.lidars == "several", arguments.thin, arguments.all_rays,
                            arguments.returns, arguments.season, fraction if arguments.fractions else 1))


if __name__ == "__main__":
    main()
