#pragma once

#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/density/comparison.h"
#include "rayfield/density/findings.h"
#include "rayfield/formats/report.h"
#include "rayfield/tile/store.h"

namespace rayfield::cli {

/// What `rayfield report --set` sets.
struct ReportSettings {
  density::ComparisonOptions compare;
  density::GapOptions gaps;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.group("compare", o.compare);
    v.group("gaps", o.gaps);
  }
};

struct ReportRequest {
  std::vector<std::string> dates;  ///< scan ids or dates; empty = all
  ReportSettings settings;
};

/// Whether a report may be written there, asked before any work. A report that is there is replaced, another file only
/// with `overwrite`. Errors: resources (a folder in the way, no permission, no space), usage (no such folder, another
/// file).
Result<void> check_report_target(const std::string& path, bool overwrite);

/// Everything that a report shows, of the newest snapshot. Errors: usage (not processed, unknown date), damaged,
/// interrupted.
Result<formats::BlockReport> load_report(const tile::Store& store, const ReportRequest& request, Progress& progress);

}  // namespace rayfield::cli
