#pragma once

#include <vector>

#include "libdensity/posts/posts.h"
#include "libdensity/posts/stem_thickness.h"

namespace rayfield::density {

inline constexpr double kOffPlace = 0.06;     ///< how far a post may stand off a multiple of the spacing, in spacings
inline constexpr double kPlaceReachM = 0.35;  ///< least distance at which a post is looked for

/// The distance at whose places what stands differs most from what stands elsewhere; NaN where no two witnesses of a
/// row are as far apart as a panel can be long.
struct UsualSpacing {
  double spacing_m = 0;
  /// At least four witnesses stand at multiples of the spacing from one of their row, and these are most, or the places
  /// differ from the rest beyond doubt: canes may make most vines as high as posts.
  bool regular = false;
};
UsualSpacing usual_spacing(const std::vector<std::vector<PlacedStem>>& stems,
                           const std::vector<std::vector<std::size_t>>& witnesses, const StemThickness& thickness,
                           double min_m, double max_m);

/// Into how many panels the usual spacing has to be split, 1 to 3: where every second or third post stands at a vine,
/// the witnesses show the others alone. Those posts' feet tell then: stems at their places, at most of which there are
/// some, that are thicker than nine of ten stems elsewhere, or, where no trunks are seen and hardly any stem stands
/// elsewhere, as thick as posts inside the rows.
int parts_of_spacing(const std::vector<std::vector<PlacedStem>>& stems,
                     const std::vector<std::vector<std::size_t>>& witnesses, double spacing_m, double min_m);

}  // namespace rayfield::density
