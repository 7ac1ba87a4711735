#include "libdensity/registry/identity.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <tuple>

#include "libdensity/layout/polyline.h"
#include "rayfield/core/uuid.h"

namespace rayfield::density {
namespace {

// Centimetres name a place well enough; the same geometry is read back bit for bit from the layout.
std::string place(const Eigen::Vector2d& p) { return fmt::format("{:.2f} {:.2f}", p.x(), p.y()); }

const Row* find_row(const RowLayout& layout, int number) {
  for (const Row& row : layout.rows)
    if (row.number == number) return &row;
  return nullptr;
}

// Mean distance of a row's vertices from another row, where they lie beside it; nothing where less than half of the
// shorter row does.
std::optional<double> distance_beside(const Row& a, const Row& b) {
  const Row& shorter = a.length_m() <= b.length_m() ? a : b;
  const Row& longer = &shorter == &a ? b : a;
  constexpr double kFar = 5;  // m; rows are not followed point by point when their middles are further apart
  const Eigen::Vector2d middle = shorter.centreline[shorter.centreline.size() / 2];
  if (std::abs(project_onto_line(longer.centreline, middle).across_m) > kFar) return std::nullopt;
  double sum = 0;
  std::size_t beside = 0;
  for (const Eigen::Vector2d& p : shorter.centreline) {
    const LineProjection on_line = project_onto_line(longer.centreline, p);
    if (!on_line.inside) continue;
    sum += std::abs(on_line.across_m);
    ++beside;
  }
  if (beside == 0 || 2 * beside < shorter.centreline.size()) return std::nullopt;
  return sum / static_cast<double>(beside);
}

// Things of a kind that may be the same, and how far apart they are. Given away from the closest pair on.
struct Pair {
  double distance_m = 0;
  std::size_t known = 0, mine = 0;
};

template <class Give>
void give_closest_first(std::vector<Pair> pairs, const Give& give) {
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.distance_m, a.known, a.mine) < std::tie(b.distance_m, b.known, b.mine);
  });
  std::set<std::size_t> given, named;
  for (const Pair& pair : pairs) {
    if (given.count(pair.known) > 0 || named.count(pair.mine) > 0) continue;
    given.insert(pair.known), named.insert(pair.mine);
    give(pair.known, pair.mine);
  }
}

// Where it was found or surveyed stays the layout's own business, and so do dates that it knows.
void give_identity(const Identity& known, Identity& mine) {
  mine.uid = known.uid;
  if (mine.source.empty()) mine.source = known.source;
  const bool dated =
      !mine.valid_from.empty() || !mine.valid_to.empty() || !mine.used_from.empty() || !mine.used_to.empty();
  if (dated) return;
  mine.valid_from = known.valid_from, mine.valid_to = known.valid_to;
  mine.used_from = known.used_from, mine.used_to = known.used_to;
}

template <class Things>
std::set<std::string> uids_of(const Things& things) {
  std::set<std::string> uids;
  for (const auto& thing : things) uids.insert(thing.identity.uid);
  uids.erase("");
  return uids;
}

struct Borders {
  Eigen::Vector2d start, end;
};

std::vector<Borders> borders_of(const RowLayout& layout) {
  std::vector<Borders> borders;
  for (const Panel& panel : layout.panels) {
    borders.push_back({Eigen::Vector2d::Constant(std::nan("")), Eigen::Vector2d::Constant(std::nan(""))});
    const Row* row = find_row(layout, panel.row);
    if (row == nullptr) continue;
    borders.back().start = point_at(row->centreline, panel.start_m).position;
    borders.back().end = point_at(row->centreline, panel.end_m).position;
  }
  return borders;
}

// How far apart the further of the borders is. A row may have been turned round in between.
double border_distance(const Borders& a, const Borders& b) {
  return std::min(std::max((a.start - b.start).norm(), (a.end - b.end).norm()),
                  std::max((a.start - b.end).norm(), (a.end - b.start).norm()));
}

}  // namespace

void name_by_place(RowLayout& layout, const std::string& crs) {
  // What is planted where something stood before is something else.
  std::set<std::string> taken = uids_of(layout.rows);
  taken.merge(uids_of(layout.panels));
  taken.merge(uids_of(layout.posts));
  const auto give = [&](Identity& identity, const char* kind, const std::string& where) {
    for (int n = 1; identity.uid.empty(); ++n) {
      const std::string uid =
          named_uuid(fmt::format("rayfield {} {}", kind, crs), n == 1 ? where : fmt::format("{} {}", where, n));
      if (taken.insert(uid).second) identity.uid = uid;
    }
  };
  for (Row& row : layout.rows)
    give(row.identity, "row", place(row.centreline.front()) + " " + place(row.centreline.back()));
  const std::vector<Borders> borders = borders_of(layout);
  for (std::size_t i = 0; i < layout.panels.size(); ++i)
    give(layout.panels[i].identity, "panel", place(borders[i].start) + " " + place(borders[i].end));
  for (Post& post : layout.posts) give(post.identity, "post", place(post.position));
}

void take_over_identities(const RowLayout& known, RowLayout& layout) {
  constexpr double kSameRow = 0.7, kSamePost = 0.25, kSameBorder = 0.5;  // m

  std::vector<Pair> pairs;
  const std::set<std::string> known_rows = uids_of(known.rows), rows = uids_of(layout.rows);
  for (std::size_t k = 0; k < known.rows.size(); ++k)
    for (std::size_t m = 0; m < layout.rows.size(); ++m) {
      if (rows.count(known.rows[k].identity.uid) > 0 || known_rows.count(layout.rows[m].identity.uid) > 0) continue;
      const auto distance = distance_beside(known.rows[k], layout.rows[m]);
      if (distance && *distance < kSameRow) pairs.push_back({*distance, k, m});
    }
  give_closest_first(std::move(pairs), [&](std::size_t k, std::size_t m) {
    Row& row = layout.rows[m];
    give_identity(known.rows[k].identity, row.identity);
    if (row.farm_number == 0) row.farm_number = known.rows[k].farm_number;
    if (row.name.empty()) row.name = known.rows[k].name;
  });

  pairs.clear();
  const std::set<std::string> known_posts = uids_of(known.posts), posts = uids_of(layout.posts);
  for (std::size_t k = 0; k < known.posts.size(); ++k)
    for (std::size_t m = 0; m < layout.posts.size(); ++m) {
      if (posts.count(known.posts[k].identity.uid) > 0 || known_posts.count(layout.posts[m].identity.uid) > 0) continue;
      const double distance = (known.posts[k].position - layout.posts[m].position).norm();
      if (distance < kSamePost) pairs.push_back({distance, k, m});
    }
  give_closest_first(std::move(pairs), [&](std::size_t k, std::size_t m) {
    give_identity(known.posts[k].identity, layout.posts[m].identity);
  });

  pairs.clear();
  const std::set<std::string> known_panels = uids_of(known.panels), panels = uids_of(layout.panels);
  const std::vector<Borders> known_borders = borders_of(known), borders = borders_of(layout);
  for (std::size_t k = 0; k < known.panels.size(); ++k)
    for (std::size_t m = 0; m < layout.panels.size(); ++m) {
      if (panels.count(known.panels[k].identity.uid) > 0 || known_panels.count(layout.panels[m].identity.uid) > 0)
        continue;
      const double distance = border_distance(known_borders[k], borders[m]);
      if (distance < kSameBorder) pairs.push_back({distance, k, m});
    }
  give_closest_first(std::move(pairs), [&](std::size_t k, std::size_t m) {
    give_identity(known.panels[k].identity, layout.panels[m].identity);
  });
}

RowLayout layout_on(const RowLayout& layout, std::string_view date) {
  RowLayout used;
  used.spacing_m = layout.spacing_m;
  std::set<int> numbers;
  for (const Row& row : layout.rows) {
    if (!row.identity.used_on(date)) continue;
    used.rows.push_back(row);
    numbers.insert(row.number);
  }
  for (const Panel& panel : layout.panels)
    if (numbers.count(panel.row) > 0) used.panels.push_back(panel);
  for (const Post& post : layout.posts) {
    if (numbers.count(post.row) == 0) continue;
    used.posts.push_back(post);
    used.posts.back().detected = post.detected && post.identity.used_on(date);
  }
  for (const Trunk& trunk : layout.trunks)
    if (numbers.count(trunk.row) > 0) used.trunks.push_back(trunk);
  return used;
}

}  // namespace rayfield::density
