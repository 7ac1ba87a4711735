#pragma once

#include <Eigen/Core>
#include <map>
#include <span>

#include "libdensity/ground/ground.h"
#include "rayfield/core/grid2.h"

namespace rayfield::density {

/// The low-histogram cells of a tile and its halo as one lattice. Cell (0,0) is the south-west one of the halo.
class GroundCells {
 public:
  GroundCells(tile::TileIndex index, std::span<const TileSurvey* const> surveys, int halo_cells);
  int size() const { return size_; }  ///< cells per side, halo included
  int halo() const { return halo_; }  ///< cells
  double cell_m() const { return cell_m_; }
  std::span<const LowBin> bins(int ix, int iy) const;  ///< empty where no tile was given
  double bin_m() const { return bin_m_; }
  /// Map coordinates of the lattice's south-west corner.
  const Eigen::Vector2d& corner() const { return corner_; }

 private:
  std::map<tile::TileIndex, const TileSurvey*> tiles_;
  tile::TileIndex index_;
  int cells_ = 0, halo_ = 0, size_ = 0;
  double cell_m_ = 0, bin_m_ = 0;
  Eigen::Vector2d corner_;
};

/// Per cell the height of the lowest supported hits, NaN where there are none: candidates for the hull.
Grid2<double> supported_lows(const GroundCells& cells, const GroundOptions& options);

/// Height of the ground in a cell: the lowest mode of its hits between slightly below and max_rise_m above `hull_m`.
struct CellMode {
  double height_m = 0;
  double weight = 0;  ///< hits that belong to the mode, at most 30; 0 = no mode
};
CellMode ground_mode(std::span<const LowBin> bins, double bin_m, double hull_m, const GroundOptions& options);

}  // namespace rayfield::density
