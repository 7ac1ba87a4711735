#include "libdensity/learning/learn.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libdensity/layout/polyline.h"
#include "libdensity/posts/post_lattice.h"
#include "libdensity/registry/identity.h"
#include "libdensity/rows/rows.h"
#include "rayfield/core/median.h"

namespace rayfield::density {
namespace {

bool stands(const Identity& identity) { return identity.valid_to.empty(); }

// The panels' borders stay where they are: chainage_m is theirs.
void see_inferred(Post& post, const Row& row, const Stem& stem, const std::string& date) {
  post.detected = true;
  post.position = stem.position, post.lean = stem.lean;
  post.across_m = project_onto_line(row.centreline, stem.position).across_m;
  post.height_m = stem.top_m, post.radius_m = stem.radius_m;
  post.identity.used_from = date;
}

}  // namespace

Learner::Learner(RowLayout found, const RegistryOptions& options, const RowOptions& rows, std::string crs)
    : layout_(std::move(found)), options_(options), row_options_(rows), crs_(std::move(crs)) {
  std::vector<double> posts, trunks;
  for (const Post& post : layout_.posts)
    if (post.detected) posts.push_back(post.radius_m);
  for (const Trunk& trunk : layout_.trunks) trunks.push_back(trunk.radius_m);
  const double post = median_of(posts, 0), trunk = median_of(trunks, 0);
  constexpr double kTold = 0.006;  // m; less, and thickness does not tell posts from trunks
  if (post - trunk > kTold) least_radius_m_ = 0.5 * (post + trunk);
  name_by_place(layout_, crs_);
}

void Learner::take(const DatedEvidence& dated) {
  for (Row& row : layout_.rows) {
    if (!stands(row.identity) || !row.identity.used_on(dated.date)) continue;
    const std::vector<PlacedStem> stems = stems_of_row(row, dated.evidence.stems);
    std::vector<KnownStem> known = compare(row, stems);
    if (row_is_gone(row, dated, known)) continue;
    learn_absent_posts(known, dated.date);
    // A scan that does not show what is known is not in place, or saw little: it teaches nothing of where posts are.
    if (known.size() < 3 || 2 * count_seen(known) < known.size()) continue;
    learn_present_posts(row, stems, dated);
  }
  append_rows(dated);
  name_by_place(layout_, crs_);
  passes_.insert(passes_.end(), dated.evidence.passes.begin(), dated.evidence.passes.end());
}

std::size_t Learner::count_seen(const std::vector<KnownStem>& known) {
  return static_cast<std::size_t>(std::count_if(known.begin(), known.end(), [](const KnownStem& k) { return k.seen; }));
}

// What stands in the row as far as the registry knows, along it.
std::vector<Learner::KnownStem> Learner::compare(const Row& row, const std::vector<PlacedStem>& stems) const {
  std::vector<KnownStem> known;
  for (std::size_t i = 0; i < layout_.posts.size(); ++i) {
    const Post& post = layout_.posts[i];
    if (post.row == row.number && post.detected && stands(post.identity))
      known.push_back({project_onto_line(row.centreline, post.position).chainage_m, post.position, i, false});
  }
  for (const Trunk& trunk : layout_.trunks)
    if (trunk.row == row.number) known.push_back({trunk.chainage_m, trunk.position, std::nullopt, false});
  std::sort(known.begin(), known.end(),
            [](const KnownStem& a, const KnownStem& b) { return a.chainage_m < b.chainage_m; });
  for (KnownStem& k : known)
    k.seen = std::any_of(stems.begin(), stems.end(), [&](const PlacedStem& s) {
      return (s.stem.position - k.position).norm() < options_.known_within_m;
    });
  return known;
}

// The row was driven along, no canopy stands there, and hardly any of its stems.
bool Learner::row_is_gone(Row& row, const DatedEvidence& dated, const std::vector<KnownStem>& known) {
  constexpr double kFew = 0.1;
  const auto sighting = std::find_if(dated.evidence.rows.begin(), dated.evidence.rows.end(),
                                     [&](const ScanEvidence::RowSighting& s) { return s.row == row.number; });
  if (sighting == dated.evidence.rows.end()) return false;
  const bool any = sighting->canopy || static_cast<double>(count_seen(known)) >
                                           kFew * static_cast<double>(std::max<std::size_t>(1, known.size()));
  Absence& absence = absent_rows_[row.number];
  if (any) {
    absence = {};
    return false;
  }
  if (sighting->driven < options_.min_driven_share) return true;  // nobody looked
  if (absence.dates++ == 0) absence.since = dated.date;
  if (absence.dates < options_.absent_dates) return true;
  row.identity.valid_to = absence.since, row.identity.used_to = dated.date;
  for (Post& post : layout_.posts)
    if (post.row == row.number && stands(post.identity))
      post.identity.valid_to = absence.since, post.identity.used_to = dated.date;
  return true;
}

// True where the scan shows the stems around a place: at least four of the up to three nearest on each side, and most
// of them. Leaves and weeds that hide a post hide its neighbours too, and so does a lane that was not driven.
bool Learner::well_observed(const std::vector<KnownStem>& known, std::size_t at) const {
  constexpr std::size_t kEachSide = 3, kLeast = 4;
  constexpr double kReach = 10;  // m
  std::size_t all = 0, seen = 0;
  const auto look = [&](std::size_t i) {
    if (std::abs(known[i].chainage_m - known[at].chainage_m) > kReach) return;
    ++all;
    seen += known[i].seen ? 1 : 0;
  };
  for (std::size_t k = 1; k <= kEachSide && k <= at; ++k) look(at - k);
  for (std::size_t k = 1; k <= kEachSide && at + k < known.size(); ++k) look(at + k);
  const bool beside = (at == 0 || known[at - 1].seen) && (at + 1 == known.size() || known[at + 1].seen);
  return all >= std::min(kLeast, known.size() - 1) && all >= 3 && beside &&
         static_cast<double>(seen) >= options_.min_seen_share * static_cast<double>(all);
}

void Learner::learn_absent_posts(const std::vector<KnownStem>& known, const std::string& date) {
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!known[i].post) continue;
    Absence& absence = absent_posts_[*known[i].post];
    if (known[i].seen) absence = {};
    if (known[i].seen || !well_observed(known, i)) continue;
    if (absence.dates++ == 0) absence.since = date;
    if (absence.dates < options_.absent_dates) continue;
    Identity& identity = layout_.posts[*known[i].post].identity;
    identity.valid_to = absence.since, identity.used_to = date;
  }
}

bool Learner::on_a_trunk(int row, const Eigen::Vector2d& p) const {
  constexpr double kOnTrunk = 0.10;  // m
  return std::any_of(layout_.trunks.begin(), layout_.trunks.end(),
                     [&](const Trunk& trunk) { return trunk.row == row && (trunk.position - p).norm() < kOnTrunk; });
}

// The standing post nearest to a place, within reach.
Post* Learner::post_near(int row, const Eigen::Vector2d& p) {
  Post* nearest = nullptr;
  double least = options_.same_post_m;
  for (Post& post : layout_.posts) {
    const double distance = (post.position - p).norm();
    if (post.row != row || !stands(post.identity) || distance >= least) continue;
    nearest = &post, least = distance;
  }
  return nearest;
}

void Learner::learn_present_posts(const Row& row, const std::vector<PlacedStem>& stems, const DatedEvidence& dated) {
  for (const std::size_t i : sure_posts(stems)) {
    const Stem& stem = stems[i].stem;
    if (on_a_trunk(row.number, stem.position) || stem.radius_m < least_radius_m_) continue;
    if (Post* post = post_near(row.number, stem.position)) {
      if (!post->detected) see_inferred(*post, row, stem, dated.date);
      continue;
    }
    note_candidate(row, stem, dated);
  }
}

void Learner::note_candidate(const Row& row, const Stem& stem, const DatedEvidence& dated) {
  const auto same = std::find_if(candidates_.begin(), candidates_.end(), [&](const Candidate& c) {
    return c.row == row.number && (c.position - stem.position).norm() <= options_.same_place_m;
  });
  if (same == candidates_.end()) {
    candidates_.push_back({row.number, dated.date, dated.scan_id, dated.date, 1, stem.position});
    return;
  }
  if (same->last_date == dated.date) return;  // two drives of one day are one date
  same->position += (stem.position - same->position) / (same->dates + 1);
  ++same->dates, same->last_date = dated.date;
  if (same->dates < options_.present_dates) return;
  Post post;
  post.row = row.number;
  post.position = same->position, post.lean = stem.lean;
  const LineProjection on_line = project_onto_line(row.centreline, post.position);
  post.chainage_m = on_line.chainage_m, post.across_m = on_line.across_m;
  post.height_m = stem.top_m, post.radius_m = stem.radius_m;
  post.identity.valid_from = same->first_date, post.identity.used_from = dated.date;
  post.identity.source = "found in " + same->first_scan;
  layout_.posts.push_back(std::move(post));
  candidates_.erase(same);
}

// True where an earlier scan drove along a line, and would have shown a row.
bool Learner::driven_before(const Row& row) const {
  std::vector<Pass> passes;
  for (const auto& line : passes_) passes.push_back({line, 0, 0});
  const auto [left, right] = driven_shares(row.centreline, passes, row_options_);
  return std::max(left, right) >= options_.min_driven_share;
}

void Learner::append_rows(const DatedEvidence& dated) {
  constexpr double kBeside = 0.7;  // m
  const RowLayout& found = dated.evidence.new_rows;
  for (const Row& candidate : found.rows) {
    const bool known = std::any_of(layout_.rows.begin(), layout_.rows.end(), [&](const Row& row) {
      return stands(row.identity) && share_beside(candidate.centreline, row.centreline, kBeside) > 0;
    });
    if (!known) append_row(found, candidate, dated);
  }
}

// A row and what stands in it, under numbers of its own.
void Learner::append_row(const RowLayout& found, const Row& candidate, const DatedEvidence& dated) {
  Row row = candidate;
  Identity identity;
  if (driven_before(row)) identity.valid_from = dated.date;
  identity.used_from = dated.date, identity.source = "found in " + dated.scan_id;
  row.identity = identity;
  int number = 0, shown = 0;
  for (const Row& other : layout_.rows)
    number = std::max(number, other.number), shown = std::max(shown, other.shown_number());
  row.number = number + 1, row.farm_number = shown == number ? 0 : shown + 1;
  for (Post post : found.posts)
    if (post.row == candidate.number) {
      post.row = row.number, post.identity = identity;
      layout_.posts.push_back(std::move(post));
    }
  for (Panel panel : found.panels)
    if (panel.row == candidate.number) {
      panel.row = row.number, panel.identity = identity;
      layout_.panels.push_back(std::move(panel));
    }
  for (Trunk trunk : found.trunks)
    if (trunk.row == candidate.number) {
      trunk.row = row.number;
      layout_.trunks.push_back(trunk);
    }
  layout_.rows.push_back(std::move(row));
}

}  // namespace rayfield::density
