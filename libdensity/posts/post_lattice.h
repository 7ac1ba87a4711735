#pragma once

#include <vector>

#include "libdensity/posts/post_spacing.h"
#include "libdensity/posts/posts.h"
#include "libdensity/posts/stem_thickness.h"

namespace rayfield::density {

/// Indices of the stems that are posts by themselves: as dense with hits above the trunks' height as below it, or solid
/// within the canopy. Ascending.
std::vector<std::size_t> sure_posts(const std::vector<PlacedStem>& stems);

/// Indices of the stems that show the spacing of the posts, ascending: sure posts, and, since in a dense canopy hardly
/// anything of a post is seen but its foot, stems between two vines that are one vine spacing apart, and thick ones
/// where thickness tells posts. NaN: the vine spacing is unknown.
std::vector<std::size_t> spacing_witnesses(const std::vector<PlacedStem>& stems, const std::vector<std::size_t>& sure,
                                           double trunk_spacing_m, const StemThickness& thickness);

/// What posts and trunks of a block usually are like.
struct UsualStems {
  double spacing_m = 0;  ///< of posts; NaN if unknown
  bool regular = false;  ///< see UsualSpacing
  double post_radius_m = 0.05, trunk_radius_m = 0.025;
  double trunk_spacing_m = 0;  ///< of vines; NaN if unknown
  StemThickness thickness;
};

struct PostChoice {
  std::vector<std::size_t> posts;  ///< indices of stems, ascending
  std::vector<double> inferred_m;  ///< chainages where the regular spacing wants a post that was not seen
};

/// Where at least half of a row's `witnesses` (those of its spacing) stand at the usual spacing, or the whole block is
/// regular: walks along it from the surest, takes the best candidate near each place, infers a post where there is
/// none, and leaves out what stands in between. Elsewhere the sure posts, less those that stand too close to better
/// ones. A sure post at the row's end is always kept.
PostChoice choose_posts(const std::vector<PlacedStem>& stems, const std::vector<std::size_t>& sure,
                        const std::vector<std::size_t>& witnesses, const UsualStems& usual, double row_length_m);

}  // namespace rayfield::density
