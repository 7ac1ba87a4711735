#pragma once

#include <vector>

#include "libdensity/layout/row_layout.h"
#include "libdensity/posts/posts.h"
#include "libdensity/rows/passes.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// What one scan shows of a layout that is known already: evidence for and against what the registry says.
struct ScanEvidence {
  struct RowSighting {
    int row = 0;          ///< Row::number
    bool canopy = false;  ///< a row was found here, too
    double driven = 0;    ///< share of its length that was driven along, on the better side
  };
  std::vector<Stem> stems;                           ///< along the known rows
  std::vector<RowSighting> rows;                     ///< of the known rows
  std::vector<std::vector<Eigen::Vector2d>> passes;  ///< where the vehicle drove along lanes
  /// Rows beside the known ones, with posts, panels and trunks, numbered from 1 among themselves.
  RowLayout new_rows;
};

/// Stored form, kind "stems" version 1. Errors: damaged.
tile::ArraySet evidence_to_arrays(const ScanEvidence& evidence);
Result<ScanEvidence> evidence_from_arrays(const tile::ArraySet& arrays);

}  // namespace rayfield::density
