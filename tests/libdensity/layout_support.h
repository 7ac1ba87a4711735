#pragma once

#include <vector>

#include "libdensity/layout/row_layout.h"
#include "libdensity/posts/posts.h"
#include "libdensity/registry/identity.h"

/// Small layouts of known geometry: rows to the north, 3 m apart, posts every 6 m, a vine every 1.5 m between them.
namespace rayfield::density::testing {

inline constexpr const char* kCrs = "EPSG:7854";
inline const Eigen::Vector2d kCorner(500000, 6100000);

inline Row straight_row(int number, double east_m, double length_m = 24) {
  Row row;
  row.number = number;
  for (double n = 0; n <= length_m + 1e-9; n += 0.5) row.centreline.push_back(kCorner + Eigen::Vector2d(east_m, n));
  return row;
}

inline Post post_at(int row, double east_m, double north_m, bool detected = true) {
  Post post;
  post.row = row, post.chainage_m = north_m, post.position = kCorner + Eigen::Vector2d(east_m, north_m);
  post.height_m = 1.8, post.radius_m = 0.05, post.detected = detected;
  return post;
}

inline RowLayout trellis(int rows = 3, double spacing_m = 3) {
  RowLayout layout;
  layout.spacing_m = spacing_m;
  for (int r = 1; r <= rows; ++r) {
    const double east = (r - 1) * spacing_m;
    layout.rows.push_back(straight_row(r, east));
    for (int p = 0; p <= 4; ++p) layout.posts.push_back(post_at(r, east, 6.0 * p));
    for (double n = 0.75; n < 24; n += 1.5)
      layout.trunks.push_back({r, n, 0, kCorner + Eigen::Vector2d(east, n), 0.025, 0.9});
  }
  make_panels(layout, std::nullopt);
  name_by_place(layout, kCrs);
  return layout;
}

/// What a scan that sees everything shows of a layout.
inline std::vector<Stem> stems_of(const RowLayout& layout) {
  std::vector<Stem> stems;
  for (const Post& post : layout.posts)
    if (post.detected) stems.push_back({post.row, post.position, post.lean, post.radius_m, post.height_m, 10, 1.0, 0});
  for (const Trunk& trunk : layout.trunks)
    stems.push_back({trunk.row, trunk.position, Eigen::Vector2d::Zero(), trunk.radius_m, trunk.top_m, 10, 0, 0});
  return stems;
}

}  // namespace rayfield::density::testing
