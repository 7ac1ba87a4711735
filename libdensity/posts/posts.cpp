#include "libdensity/posts/posts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "libdensity/layout/polyline.h"
#include "libdensity/layout/row_order.h"
#include "libdensity/posts/post_lattice.h"
#include "libdensity/rows/rows.h"
#include "libdensity/tiles/rounding.h"
#include "rayfield/core/median.h"

namespace rayfield::density {
namespace {

constexpr const char* kWhat = "cannot find the posts";
constexpr double kEndReach = 1.5;  // m; a post this close to where the canopy ends is the row's end post

// Bends the centreline to the stems. The traced canopy holds it where there are none, loosely where only one side of
// the canopy was seen.
void refine_centreline(Row& row, const std::vector<PlacedStem>& posts, const std::vector<PlacedStem>& trunks,
                       const PostOptions& options) {
  constexpr double kStep = 0.5;
  row.centreline = resampled(row.centreline, kStep);
  const std::size_t n = row.centreline.size();
  const double step = row.length_m() / static_cast<double>(n - 1);
  std::vector<double> shift(n, 0.0), weight(n, row.seen_from_left && row.seen_from_right ? 0.1 : 0.01);
  const auto pull = [&](const std::vector<PlacedStem>& stems, double strength) {
    for (const PlacedStem& s : stems) {
      const double at = std::clamp(s.chainage_m / step, 0.0, static_cast<double>(n - 1));
      const std::size_t i = static_cast<std::size_t>(std::lround(at));
      shift[i] = (shift[i] * weight[i] + s.across_m * strength) / (weight[i] + strength);
      weight[i] += strength;
    }
  };
  pull(posts, 4), pull(trunks, 1);
  const double stiffness = std::pow(options.smoothing_m / (2 * M_PI * kStep), 6) * 0.3;
  const std::vector<double> smooth = smooth_values(shift, weight, stiffness, 0.2);
  std::vector<Eigen::Vector2d> moved;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d u = (row.centreline[std::min(i + 1, n - 1)] - row.centreline[i > 0 ? i - 1 : 0]).normalized();
    moved.push_back(row.centreline[i] + smooth[i] * Eigen::Vector2d(-u.y(), u.x()));
  }
  row.centreline = std::move(moved);
}

Post make_post(const Row& row, const PlacedStem& s) {
  Post post;
  post.row = row.number;
  post.position = s.stem.position, post.lean = s.stem.lean;
  post.height_m = s.stem.top_m, post.radius_m = s.stem.radius_m;
  const LineProjection on_line = project_onto_line(row.centreline, post.position);
  post.chainage_m = on_line.chainage_m, post.across_m = on_line.across_m;
  return post;
}

// Ends at the outermost posts, new vertices, chainage 0 at the first end. Returns what was cut off at the start.
double cut_ends(Row& row, const std::vector<PlacedStem>& posts) {
  const double length = row.length_m();
  double start = 0, end = length;
  if (!posts.empty()) {
    const double first = project_onto_line(row.centreline, posts.front().stem.position).chainage_m;
    const double last = project_onto_line(row.centreline, posts.back().stem.position).chainage_m;
    if (std::abs(first) < kEndReach) start = first;
    if (std::abs(last - length) < kEndReach) end = last;
  }
  row.centreline = resampled(sub_line(row.centreline, start, end), 0.5);
  return start;
}

// The usual distance between neighbouring stems: that of the vines, as most stems are theirs.
double usual_gap(const std::vector<std::vector<PlacedStem>>& stems) {
  std::vector<double> gaps;
  for (const std::vector<PlacedStem>& row : stems)
    for (std::size_t i = 1; i < row.size(); ++i) gaps.push_back(row[i].chainage_m - row[i - 1].chainage_m);
  return median_of(std::move(gaps));
}

struct RowStems {
  std::vector<PlacedStem> posts, trunks;
  std::vector<double> inferred;
};

// The vines of a block are trained to one height; a trunk that seems to go on above it has a cane or leaves on its
// axis.
void end_trunks_at_usual_height(std::vector<RowStems>& rows) {
  std::vector<double> tops;
  for (const RowStems& row : rows)
    for (const PlacedStem& trunk : row.trunks) tops.push_back(trunk.stem.top_m);
  const double usual = median_of(tops, 0);
  for (RowStems& row : rows)
    for (PlacedStem& trunk : row.trunks) trunk.stem.top_m = std::min(trunk.stem.top_m, usual);
}

void build_row(RowLayout& layout, Row& row, const RowStems& stems, const PostOptions& options, double usual_height,
               double usual_radius, PostReport& report) {
  // Places of unseen posts are kept as points: the centreline under them is about to move.
  std::vector<Eigen::Vector2d> unseen;
  for (double chainage : stems.inferred) unseen.push_back(point_at(row.centreline, chainage).position);
  refine_centreline(row, stems.posts, stems.trunks, options);
  cut_ends(row, stems.posts);
  std::vector<Post> posts;
  for (const PlacedStem& s : stems.posts) posts.push_back(make_post(row, s));
  for (const Eigen::Vector2d& p : unseen) {
    Post post;
    post.row = row.number;
    post.chainage_m = project_onto_line(row.centreline, p).chainage_m;
    post.position = point_at(row.centreline, post.chainage_m).position;
    post.height_m = usual_height, post.radius_m = usual_radius, post.detected = false;
    posts.push_back(post);
  }
  std::sort(posts.begin(), posts.end(), [](const Post& a, const Post& b) { return a.chainage_m < b.chainage_m; });
  report.detected += static_cast<int>(stems.posts.size());
  report.inferred += static_cast<int>(unseen.size());
  layout.posts.insert(layout.posts.end(), posts.begin(), posts.end());
  for (const PlacedStem& s : stems.trunks) {
    const LineProjection on_line = project_onto_line(row.centreline, s.stem.position);
    layout.trunks.push_back(
        {row.number, on_line.chainage_m, on_line.across_m, s.stem.position, s.stem.radius_m, s.stem.top_m});
  }
  report.trunks += static_cast<int>(stems.trunks.size());
}

// What posts and trunks are usually like, judging by the stems that are taken for posts so far, `posts_of(row)`.
template <class PostsOf>
void learn_usual(const std::vector<std::vector<PlacedStem>>& placed, const PostsOf& posts_of, UsualStems& usual) {
  std::vector<double> post_radii, trunk_radii, trunk_gaps;
  for (std::size_t r = 0; r < placed.size(); ++r) {
    const std::vector<std::size_t>& posts = posts_of(r);
    const PlacedStem* trunk = nullptr;
    for (std::size_t i = 0; i < placed[r].size(); ++i) {
      if (std::binary_search(posts.begin(), posts.end(), i)) {
        post_radii.push_back(placed[r][i].stem.radius_m);
        continue;
      }
      trunk_radii.push_back(placed[r][i].stem.radius_m);
      if (trunk) trunk_gaps.push_back(placed[r][i].chainage_m - trunk->chainage_m);
      trunk = &placed[r][i];
    }
  }
  usual.trunk_spacing_m = median_of(trunk_gaps);
  usual.post_radius_m = median_of(post_radii, usual.post_radius_m);
  usual.trunk_radius_m = median_of(trunk_radii, usual.trunk_radius_m);
}

}  // namespace

std::vector<PlacedStem> stems_of_row(const Row& row, std::span<const Stem> stems) {
  std::vector<PlacedStem> placed;
  for (const Stem& stem : stems) {
    if (stem.row != row.number) continue;
    const LineProjection on_line = project_onto_line(row.centreline, stem.position);
    placed.push_back({stem, on_line.chainage_m, on_line.across_m});
  }
  std::sort(placed.begin(), placed.end(), [](const PlacedStem& a, const PlacedStem& b) {
    return std::tie(a.chainage_m, a.across_m) < std::tie(b.chainage_m, b.across_m);
  });
  std::vector<PlacedStem> kept;
  for (const PlacedStem& next : placed) {
    const bool same = !kept.empty() && (kept.back().stem.position - next.stem.position).norm() <
                                           kept.back().stem.radius_m + next.stem.radius_m + 0.05;
    if (!same) {
      kept.push_back(next);
    } else if (next.stem.contrast > kept.back().stem.contrast) {
      kept.back() = next;
    }
  }
  return kept;
}

Result<PostReport> place_posts(RowLayout& layout, std::span<const Stem> stems, const PostOptions& options) {
  RAYFIELD_CHECK(options.validate());
  PostReport report;
  std::vector<std::vector<PlacedStem>> placed;
  std::vector<std::vector<std::size_t>> sure;
  for (const Row& row : layout.rows) {
    placed.push_back(stems_of_row(row, stems));
    sure.push_back(sure_posts(placed.back()));
  }
  UsualStems usual;
  usual.thickness = stem_thickness(placed, sure);
  const double stem_spacing_m = usual_gap(placed);
  std::vector<std::vector<std::size_t>> witnesses;
  for (std::size_t r = 0; r < placed.size(); ++r) {
    sure[r] = without_thin(placed[r], sure[r], usual.thickness);
    witnesses.push_back(spacing_witnesses(placed[r], sure[r], stem_spacing_m, usual.thickness));
  }
  const UsualSpacing spacing =
      usual_spacing(placed, witnesses, usual.thickness, options.min_panel_m, options.max_panel_m);
  usual.spacing_m = report.panel_length_m =
      spacing.spacing_m / parts_of_spacing(placed, witnesses, spacing.spacing_m, options.min_panel_m);
  usual.regular = spacing.regular;
  // Twice: what posts are like is known better once those that stand at the spacing are separated from the rest.
  std::vector<PostChoice> choices(placed.size());
  for (int pass = 0; pass < 2; ++pass) {
    learn_usual(
        placed,
        [&](std::size_t r) -> const std::vector<std::size_t>& { return pass == 0 ? sure[r] : choices[r].posts; },
        usual);
    for (std::size_t r = 0; r < placed.size(); ++r)
      choices[r] = choose_posts(placed[r], sure[r], witnesses[r], usual, layout.rows[r].length_m());
  }

  std::vector<RowStems> sorted;
  std::vector<double> heights, radii;
  for (std::size_t r = 0; r < layout.rows.size(); ++r) {
    RowStems row;
    for (std::size_t i = 0; i < placed[r].size(); ++i) {
      const bool post = std::binary_search(choices[r].posts.begin(), choices[r].posts.end(), i);
      (post ? row.posts : row.trunks).push_back(placed[r][i]);
      if (post) heights.push_back(placed[r][i].stem.top_m), radii.push_back(placed[r][i].stem.radius_m);
    }
    row.inferred = choices[r].inferred_m;
    if (choices[r].posts.empty())
      report.warnings.push_back(fmt::format("row {}: no posts seen", layout.rows[r].number));
    sorted.push_back(std::move(row));
  }
  end_trunks_at_usual_height(sorted);
  const double usual_height = median_of(heights, 1.8), usual_radius = median_of(radii, 0.05);
  layout.posts.clear(), layout.trunks.clear();
  for (std::size_t r = 0; r < layout.rows.size(); ++r)
    build_row(layout, layout.rows[r], sorted[r], options, usual_height, usual_radius, report);
  layout.spacing_m = row_spacing(layout.rows);
  make_panels(layout, options.panel_length_m);
  return report;
}

void make_panels(RowLayout& layout, std::optional<double> panel_length_m) {
  constexpr double kShortest = 0.5;  // m; posts closer than this to each other or to an end bound no panel
  layout.panels.clear();
  for (const Row& row : layout.rows) {
    const double length = row.length_m();
    std::vector<double> borders{0};
    if (panel_length_m) {
      const int n = std::max(1, floor_int(length / *panel_length_m + 0.5));
      for (int i = 1; i < n; ++i) borders.push_back(i * *panel_length_m);
    } else {
      for (const Post& post : layout.posts)
        if (post.row == row.number && post.chainage_m > borders.back() + kShortest &&
            post.chainage_m < length - kShortest)
          borders.push_back(post.chainage_m);
    }
    borders.push_back(length);
    for (std::size_t i = 0; i + 1 < borders.size(); ++i)
      layout.panels.push_back({row.number, static_cast<int>(i) + 1, borders[i], borders[i + 1]});
  }
}

}  // namespace rayfield::density
