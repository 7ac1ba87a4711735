#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "rayfield/core/option_fields.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/core/season_products.h"

/// What to look at in the field: gaps and weak stretches of a block on one date (docs/report.md).
namespace rayfield::density {

struct GapOptions {
  double min_length_m = 0.5;
  double share_of_median = 0.2;
  double min_canopy_per_m = 0.5;
  double post_reach_m = 0.15;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("min_length_m", o.min_length_m, {0.1, 100}, "Shorter gaps are left out");
    v.number("share_of_median", o.share_of_median, {0.01, 0.9},
             "A gap is where the plant area per metre of row is below this share of the block's median on that date");
    v.number("min_canopy_per_m", o.min_canopy_per_m, {0, 100},
             "Dates on which that median is smaller, m2/m, show too little canopy to tell gaps: bare vines");
    v.number("post_reach_m", o.post_reach_m, {0, 1},
             "What stands this near to a post is the post: it neither makes nor breaks a gap");
  }
  Result<void> validate() const;
};

/// Gaps of one scan (a place in block.scans), row by row, from the columns of its side views: a gap is a run of columns
/// whose plant area per metre of row is below share_of_median times the median column of the block. Columns of which
/// less than half was seen end a gap and are never part of one, so what was not seen is no gap. Ends are as exact as
/// the columns are wide (a voxel). None on dates without canopy. Errors: usage (options, no such scan).
Result<std::vector<RowGap>> find_gaps(const BlockProducts& block, std::size_t scan, const GapOptions& options);

/// Whether at least half of a gap's length is gap among `others` too.
bool is_gap_among(const RowGap& gap, std::span<const RowGap> others);

/// For each of block.panels its class by leaf area per metre on one scan: 0 holds the weakest of `count` equally large
/// parts, count − 1 the strongest, −1 what was not seen. Equal values are in one class.
std::vector<int> panel_classes(const BlockProducts& block, std::size_t scan, int count);

/// Runs of neighbouring panels of class 0, the lowest leaf area per metre first.
std::vector<WeakStretch> weak_stretches(const BlockProducts& block, std::size_t scan, std::span<const int> classes);

}  // namespace rayfield::density
