#pragma once

#include <cstddef>
#include <vector>

#include "libdensity/posts/posts.h"

namespace rayfield::density {

/// How thick the vines of a block are at their feet, and whether that tells posts from them. In a dense canopy foot and
/// thickness are all that is seen of a post, and canes and leaves on the axis of a vine may make it look as tall as
/// one.
struct StemThickness {
  double trunk_m = 0;   ///< radius of vines, median
  double spread_m = 0;  ///< its standard deviation, from those that are thinner than the median
  /// Stems within the rows are posts if and only if they are thick, as far as can be seen.
  bool tells_posts = false;

  /// Thicker than hardly any vine.
  bool is_thick(const Stem& stem) const;
  /// Thicker than most vines: enough where stems are counted, each of which may be one of the others.
  bool is_rather_thick(const Stem& stem) const;
  /// As thin as vines usually are, and not seen to be solid.
  bool is_thin(const Stem& stem) const;
};

/// `stems`: of each row; `sure`: indices of the sure_posts() of each row. Thickness tells posts where at least four
/// stems within the rows are thick, and more of them than there are sure posts as thin as vines: blocks with line posts
/// of steel have such. Posts at the ends of rows are often thicker than line posts and not asked.
StemThickness stem_thickness(const std::vector<std::vector<PlacedStem>>& stems,
                             const std::vector<std::vector<std::size_t>>& sure);

/// The sure posts of a row without those that are vines: thin ones, where thickness tells.
std::vector<std::size_t> without_thin(const std::vector<PlacedStem>& stems, const std::vector<std::size_t>& sure,
                                      const StemThickness& thickness);

}  // namespace rayfield::density
