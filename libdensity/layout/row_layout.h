#pragma once
/// layout: what a block consists of (rows, panels, posts, trunks), and the geometry of their lines.
#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rayfield/core/grid3.h"

namespace rayfield::density {

/// What names a row, panel or post for ever, and from when to when it stands. Dates are YYYY-MM-DD; `to` dates are the
/// first on which it is gone, empty = no bound known.
struct Identity {
  std::string uid;                   ///< UUID; never changes, also when the geometry is refined
  std::string valid_from, valid_to;  ///< in the field
  /// The scans that take it into account, by their date. Not the same as the dates above: what a later scan teaches
  /// changes none of the scans before it (docs/registry.md).
  std::string used_from, used_to;
  std::string source;  ///< "found in <scan>" or "surveyed"
  bool used_on(std::string_view date) const {
    return (used_from.empty() || used_from <= date) && (used_to.empty() || date < used_to);
  }
};

/// A row of vines as geometry: a centreline with chainage. Positive across = left of the direction of the line.
struct Row {
  int number = 0;                           ///< from 1, in the order across the block
  std::vector<Eigen::Vector2d> centreline;  ///< vertices, m; first = chainage 0, at the row's first end
  bool seen_from_left = true, seen_from_right = true;
  Identity identity = {};
  int farm_number = 0;    ///< the farm's own number for it; 0: none, `number` stands for it
  std::string name = {};  ///< the farm's name for it; may be empty
  double length_m() const;
  int shown_number() const { return farm_number > 0 ? farm_number : number; }
};

/// Part of a row between two posts (or of a given length).
struct Panel {
  int row = 0;                    ///< Row::number
  int number = 0;                 ///< from 1 along the row
  double start_m = 0, end_m = 0;  ///< chainage
  Identity identity = {};
};

struct Post {
  int row = 0;
  double chainage_m = 0, across_m = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double height_m = 0;  ///< above the ground
  double radius_m = 0.05;
  Eigen::Vector2d lean =
      Eigen::Vector2d::Zero();  ///< horizontal shift per metre of height, map axes; position is at the ground
  bool detected = true;         ///< false: placed where the regular spacing or a survey wants one
  /// Its `used_from` and `used_to` are those of the wood: what a scan subtracts.
  Identity identity = {};
};

/// The stem of a vine between the ground and its cordon: wood whose hits are not leaves.
struct Trunk {
  int row = 0;
  double chainage_m = 0, across_m = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double radius_m = 0.025;
  double top_m = 0;  ///< above the ground: where the stem is last seen as one
};

/// The lay-out of a block: surveyed, or found in the first scan; kept, and completed by what later scans see.
struct RowLayout {
  double spacing_m = 0;  ///< median distance of neighbouring rows; NaN for a single row
  std::vector<Row> rows;
  std::vector<Panel> panels;
  std::vector<Post> posts;
  std::vector<Trunk> trunks;
};

/// The panels of one row, in their order along it.
std::vector<Panel> panels_of(const RowLayout& layout, int row);

/// Voxels of one row segment at most: far more than a row has.
inline constexpr std::int64_t kMostVoxels = std::int64_t{1} << 28;

/// A straight piece of a row with its own frame; voxels are made per row segment, so that rows may curve gently and the
/// ground under them may roll. Local coordinates of a map point p with (e, n) = p − origin in plan:
///   along = e·ux + n·uy, across = −e·uy + n·ux, up = z − (ground_m + slope_along·along + slope_across·across).
/// The shear keeps straight rays straight and volumes exact (docs/density.md, "Counting").
struct RowSegment {
  int row = 0;                                           ///< Row::number
  int index = 0;                                         ///< along the row, from 0
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();      ///< on the centreline, where the row segment begins
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< unit vector along the row
  double chainage_m = 0;                                 ///< of the origin along the row
  double ground_m = 0, slope_along = 0, slope_across = 0;
  int first_along = 0;  ///< number of the first voxel column along the row, counted from chainage 0
  int n_along = 0, n_across = 0, n_up = 0;
  double across_min_m = 0, up_min_m = 0.3;  ///< of the grid's low faces
  double voxel_m = 0.12;

  /// Voxel (along, across, up); a column is all voxels of one (along, across).
  Shape3 shape() const { return {n_along, n_across, n_up}; }
};

}  // namespace rayfield::density
