#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libdensity/estimate/row_density.h"
#include "libdensity/estimate/voxel_sums.h"

namespace rayfield::density {

/// Takes out of a row's densities what slabs read wrong (docs/density.md, "Uneven density inside a voxel"). Leaves take
/// path of the other voxels of their slabs: slab_shadow() too much. Rays prefer what is empty within a voxel, too: the
/// more too little, the larger the voxels are, and how much shows in voxels twice as large. With T(v) the area in
/// voxels of side v and T(2v) that in twice as large ones, both without slab_shadow(), a cross section is multiplied by
///   [1 + 0.62·(T(v) − T(2v))/T(v)] / (1 + slab_shadow),
/// the fraction that of the whole row, shared out in proportion to T(v) within 1.5 m along it, T(2v) the mean of the
/// two ways to put two voxels together across the row. `sums`: of the row's voxels.
void correct_uneven_density(RowDensity& row, std::span<const VoxelSums> sums);

/// The first factor, of each cross section, for leaves alone. What is missing goes with the square of the density, so
/// that of the share by which plants read too little that of the leaves among them is theirs.
std::vector<double> correction_of_leaves(const RowDensity& plant, const RowDensity& wood);

/// Memory that correct_uneven_density() takes beside the row and the sums.
std::size_t correction_bytes(const Shape3& shape);

/// Potential path of a voxel twice as large, in its own sides, from what two voxels beside each other across the row
/// say, in theirs. Rays that a leaf stops in one are missing in the potential path P of the other: with t the share
/// that passes through a voxel, A what comes in from one side and B from the other,
///   P₁ = A + t₂·B,  P₂ = B + t₁·A,  A + B = [P₁·(1 − t₁) + P₂·(1 − t₂)] / (1 − t₁·t₂).
double potential_of_two(const VoxelSums& one, const VoxelSums& other);

}  // namespace rayfield::density
