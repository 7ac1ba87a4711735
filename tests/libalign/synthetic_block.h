#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "rayfield/align/align.h"
#include "rayfield/core/landmarks.h"

namespace rayfield::align {

/// A vineyard as its posts, trunks and ground, and what scans of it show.
struct SyntheticBlock {
  int rows = 4;
  double length_m = 40, spacing_m = 2.6, panel_m = 6, vine_m = 1.5, azimuth_rad = 0.4;
  double missing = 0.05;                                ///< share of vines that are missing
  double across_jitter_m = 0.02, along_jitter_m = 0.0;  ///< of trunks
  double radius_spread = 0.15;                          ///< of trunks, relative
  double slope = 0.03, relief_m = 0.3, relief_wavelength_m = 35;
  Eigen::Vector2d middle = {281500, 6101000};
  unsigned seed = 1;

  double ground(const Eigen::Vector2d& p) const;
  Eigen::Vector2d place(int row, double chainage_m, double across_m) const;
  std::vector<Upright> uprights() const;
};

/// What one drive shows of it.
struct SyntheticDrive {
  int first_row = 0, last_row = -1;       ///< rows driven along; -1: all
  double from_m = 0, to_m = -1;           ///< part of the rows; -1: to their ends
  double detection = 0.75;                ///< share of uprights seen
  double noise_m = 0.01;                  ///< per axis
  double ghosts = 0.05;                   ///< uprights that are none, relative to those there are
  PlanShift error;                        ///< moves what was seen
  double bend_m = 0, bend_length_m = 60;  ///< smooth drift on top
  double grass_m = 0;                     ///< adds to the ground
  unsigned seed = 1;
};

BlockLandmarks drive_along(const SyntheticBlock& block, const SyntheticDrive& drive);

/// A shift as two drives with cheap GPS have it: up to 5 m per axis and 30 mrad.
PlanShift random_error(const SyntheticBlock& block, std::mt19937& random);

/// How far off the middle of the block and the end of its first row are after an alignment, m.
struct Miss {
  double middle_m = 0, end_m = 0;
};
Miss miss_of(const SyntheticBlock& block, const SyntheticDrive& drive, const Alignment& found);

}  // namespace rayfield::align
