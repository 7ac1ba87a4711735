#include "libdensity/learning/first_layout.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "libdensity/layout/polyline.h"
#include "libdensity/posts/post_lattice.h"
#include "libdensity/posts/posts.h"
#include "libdensity/posts/stem_accumulator.h"
#include "libdensity/rows/passes.h"
#include "libdensity/rows/rows.h"
#include "libdensity/tiles/accumulate.h"
#include "rayfield/core/median.h"

namespace rayfield::density {
namespace {

constexpr double kSamePost = 0.15;  // m between a surveyed post and where the scan shows it
constexpr double kBeyondEnd = 0.5;  // m; a post further from a surveyed row's end is none of its posts

// Which sides of the rows were driven along; a survey of another place shows in no row having been.
Result<void> mark_sides(ScanWork& work, const SurveyedScan& surveyed, RowLayout& layout) {
  const std::vector<Pass> passes = find_passes(surveyed.survey.path(), work.options.rows.passes);
  double nearest = std::numeric_limits<double>::infinity();
  bool any = false;
  for (Row& row : layout.rows) {
    const auto [left, right] = driven_shares(row.centreline, passes, work.options.rows);
    row.seen_from_left = left >= 0.5, row.seen_from_right = right >= 0.5;
    any = any || left > 0 || right > 0;
    for (const Pass& pass : passes)
      for (const Eigen::Vector2d& p : pass.line)
        for (const Eigen::Vector2d& end : {row.centreline.front(), row.centreline.back()})
          nearest = std::min(nearest, (p - end).norm());
  }
  if (any) return {};
  return fail(ErrorCode::bad_input, "cannot use the reference", work.scan.scan_id,
              std::isfinite(nearest)
                  ? fmt::format("the drive passes none of the surveyed rows; the nearest is {:.0f} m away", nearest)
                  : "the vehicle drove along no lane",
              "check that survey and scan are of one block and in the store's CRS; see `rayfield registry`");
}

// The stem nearest to a place, within reach; stems.size() if there is none.
std::size_t nearest_stem(const std::vector<PlacedStem>& stems, const Eigen::Vector2d& p, double reach_m) {
  std::size_t nearest = stems.size();
  for (std::size_t i = 0; i < stems.size(); ++i) {
    const double distance = (stems[i].stem.position - p).norm();
    if (distance < reach_m) nearest = i, reach_m = distance;
  }
  return nearest;
}

// Surveyed posts take what the scan shows of them; other stems of the row that are not posts by themselves are trunks.
void see_posts(RowLayout& layout, const Row& row, const std::vector<PlacedStem>& stems) {
  std::set<std::size_t> posts;
  for (const std::size_t sure : sure_posts(stems)) posts.insert(sure);
  for (Post& post : layout.posts) {
    if (post.row != row.number) continue;
    const std::size_t i = nearest_stem(stems, post.position, kSamePost);
    if (i == stems.size()) continue;
    const Stem& stem = stems[i].stem;
    posts.insert(i);
    post.detected = true, post.position = stem.position, post.lean = stem.lean;
    post.across_m = stems[i].across_m, post.height_m = stem.top_m, post.radius_m = stem.radius_m;
  }
  for (std::size_t i = 0; i < stems.size(); ++i) {
    const Stem& stem = stems[i].stem;
    if (posts.count(i) == 0)
      layout.trunks.push_back(
          {row.number, stems[i].chainage_m, stems[i].across_m, stem.position, stem.radius_m, stem.top_m});
  }
}

// No vine goes on above the median trunk (rows.md); posts that were not seen are as high and thick as those that were.
void make_alike(RowLayout& layout) {
  std::vector<double> tops, heights, radii;
  for (const Trunk& trunk : layout.trunks) tops.push_back(trunk.top_m);
  for (const Post& post : layout.posts)
    if (post.detected) heights.push_back(post.height_m), radii.push_back(post.radius_m);
  const double top = median_of(tops, 0);
  for (Trunk& trunk : layout.trunks) trunk.top_m = std::min(trunk.top_m, top);
  for (Post& post : layout.posts)
    if (!post.detected)
      post.height_m = median_of(heights, post.height_m), post.radius_m = median_of(radii, post.radius_m);
}

// Posts and trunks for rows that were surveyed without posts: found as in rows that were found, on the surveyed line.
Result<void> find_posts(RowLayout& layout, const std::vector<Stem>& stems, const std::set<int>& rows,
                        const PostOptions& options, std::vector<std::string>& notes) {
  RowLayout found;
  for (const Row& row : layout.rows)
    if (rows.count(row.number) > 0) found.rows.push_back(row);
  if (found.rows.empty()) return {};
  RAYFIELD_ASSIGN(const PostReport report, place_posts(found, stems, options));
  notes.insert(notes.end(), report.warnings.begin(), report.warnings.end());
  const auto place = [&](int number, const Eigen::Vector2d& p) {
    const auto row =
        std::find_if(layout.rows.begin(), layout.rows.end(), [&](const Row& r) { return r.number == number; });
    return project_onto_line(row->centreline, p);
  };
  const auto length_of = [&](int number) {
    return std::find_if(layout.rows.begin(), layout.rows.end(), [&](const Row& r) { return r.number == number; })
        ->length_m();
  };
  for (Post post : found.posts) {
    const LineProjection on_line = place(post.row, post.position);
    if (on_line.chainage_m < -kBeyondEnd || on_line.chainage_m > length_of(post.row) + kBeyondEnd) continue;
    post.chainage_m = on_line.chainage_m, post.across_m = on_line.across_m;
    layout.posts.push_back(std::move(post));
  }
  for (Trunk trunk : found.trunks) {
    const LineProjection on_line = place(trunk.row, trunk.position);
    trunk.chainage_m = on_line.chainage_m, trunk.across_m = on_line.across_m;
    layout.trunks.push_back(trunk);
  }
  return {};
}

}  // namespace

Result<FoundLayout> complete_survey(ScanWork& work, const SurveyedScan& surveyed, const RowLayout& survey) {
  FoundLayout found;
  RowLayout& layout = found.layout;
  layout = survey;
  RAYFIELD_CHECK(mark_sides(work, surveyed, layout));
  work.progress.stage(fmt::format("{}: posts", work.scan.scan_id), work.scan.ray_count, "rays");
  RAYFIELD_ASSIGN(const std::vector<Stem> stems, stems_along(work, surveyed.ground, layout));
  std::set<int> without_posts;
  for (const Row& row : layout.rows) without_posts.insert(row.number);
  for (const Post& post : layout.posts) without_posts.erase(post.row);
  for (const Row& row : layout.rows)
    if (without_posts.count(row.number) == 0) see_posts(layout, row, stems_of_row(row, stems));
  make_alike(layout);
  RAYFIELD_CHECK(find_posts(layout, stems, without_posts, work.options.posts, found.notes));
  std::stable_sort(layout.posts.begin(), layout.posts.end(), [](const Post& a, const Post& b) {
    return std::tie(a.row, a.chainage_m) < std::tie(b.row, b.chainage_m);
  });
  make_panels(layout, work.options.posts.panel_length_m);
  return found;
}

}  // namespace rayfield::density
