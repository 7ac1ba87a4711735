#pragma once

#include <optional>
#include <span>

#include "libdensity/echoes/full_echoes.h"
#include "libdensity/echoes/leaf_angle.h"

namespace rayfield::density {

/// What the normals of full echoes tell of how leaves are turned (docs/density.md, "How leaves are turned").
///
/// Which leaves make full echoes goes with the angle between ray and normal, and hardly with anything else. So of
/// normals at one such angle, a ring about the ray, a normal n has the likelihood γ(n_z)/⟨γ⟩_ring, γ the density of
/// leaves' normals, smoothed by the errors of the measured ones. Level rays see few of the leaves that lie flat, and
/// how many there are goes with the shape that γ is taken to have. So many shapes are weighed by their likelihood:
/// Campbell's (1986) ellipsoids, exp(a·n_z² + b·n_z⁴), and inclinations with a beta distribution (Goel & Strebel 1984),
/// which all of de Wit's are close to. Each stands for the ratio χ of that ellipsoid which is as large as it to level
/// rays; the belief beforehand is ln χ = 0 ± 0.7 and each family alike. Mean and standard deviation of ln χ over them.
/// Neighbours lie on one leaf: the likelihood counts for as much less as runs of the echoes, which are in the order of
/// their places, differ more than they would by chance.
///
/// Nothing where fewer than ten full echoes are among the flattest.
std::optional<LnRatio> fit_leaf_normals(std::span<const FullEcho> echoes);

}  // namespace rayfield::density
