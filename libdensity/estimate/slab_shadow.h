#pragma once

namespace rayfield::density {

/// By how much slabs (estimate/slab_density.h) read too dense, relative to the density, because a leaf takes potential
/// path not only of the voxel in which it is hit, which leaf_shadow() allows for, but of the other voxels of its slabs
/// too (docs/density.md, "What a leaf takes of its slabs"). Square leaves, isotropic normals, any place of the hit; few
/// enough leaves for their shadows not to overlap. Rays run as those of a drive along the row do, up to 60° off the
/// line across it and 20° off level; rays from all directions would say 1.2 to 1.5 times as much. By quadrature with
/// fixed random numbers, standard error 1 to 2 % of the value; 0 for infinitesimal leaves.
double slab_shadow(double area_m2, double voxel_m);

}  // namespace rayfield::density
