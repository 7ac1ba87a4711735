#pragma once

#include <Eigen/Core>
#include <vector>

/// What a simulated vineyard consists of: its posts and vines, and the areas and canopy of its rows.
namespace rayfield::sim {

enum class PostKind { strainer, line };

/// A trellis post; rows, posts and panels count from 0 here as in the truth files.
struct Post {
  int row = 0, post = 0;
  double chainage_m = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< east, north
  double ground_m = 0;
  double height_m = 0;
  double diameter_m = 0;
  PostKind kind = PostKind::line;
};

struct Vine {
  int row = 0;
  double chainage_m = 0;
  bool missing = false;
  double vigour = 0;        ///< relative, mean about 1
  double leaf_area_m2 = 0;  ///< one-sided, with all leaves present
};

/// One-sided leaf area and half the surface of wood (posts, trunks, cordons, canes, wires above 0.3 m over the local
/// ground), m², in consecutive intervals of a row.
struct IntervalAreas {
  std::vector<double> edges_m;  ///< chainages, one more than there are intervals
  std::vector<double> leaf_m2, wood_m2;
};
struct RowAreas {
  IntervalAreas panels, metres;  ///< `metres`: every 0.5 m, the last shorter where the length wants it
};

/// The canopy of a stretch of row as an estimator should describe it, from the triangles themselves
/// (docs/simulation.md, "Canopy"). Canopy is leaves, canes, cordons and wires above 0.3 m over the ground, without
/// posts and trunks. Heights are over the ground under the row. NaN where there is no canopy.
struct CanopyTruth {
  double base_m = 0, height_m = 0, width_m = 0;  ///< lower and upper edge; across the row
  double row_gap_share = 0;
  double porosity = 0;             ///< share of lines across the row that meet nothing
  double leaf_layer_number = 0;    ///< leaves on a line, mean
  double canopy_layer_number = 0;  ///< leaves, canes, cordons and wires on a line, mean
  double exposed_leaf_share = 0;   ///< share of the leaves on lines that are the first or the last of theirs
};
/// Areas between two heights of a panel.
struct CanopyBand {
  double low_m = 0, high_m = 0, leaf_m2 = 0, wood_m2 = 0;
};
struct RowCanopy {
  std::vector<CanopyTruth> panels, metres;        ///< as RowAreas
  std::vector<std::vector<CanopyBand>> profiles;  ///< of each panel, from the ground up
};

}  // namespace rayfield::sim
