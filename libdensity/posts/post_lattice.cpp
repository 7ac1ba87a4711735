#include "libdensity/posts/post_lattice.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace rayfield::density {
namespace {

constexpr double kSureShare = 0.7, kMaybeShare = 0.4;  // of PlacedStem::stem.upper_share
constexpr double kSureSolid = 10, kMaybeSolid = 3;     // log-likelihood ratio

double evidence(const Stem& stem) { return stem.upper_share / kSureShare + std::max(0.0, stem.solidity) / kSureSolid; }

bool maybe_post(const Stem& stem) { return stem.upper_share >= kMaybeShare || stem.solidity >= kMaybeSolid; }

bool clearly_thicker(const Stem& stem, const UsualStems& usual) {
  return usual.post_radius_m - usual.trunk_radius_m > 0.006 &&
         stem.radius_m > 0.5 * (usual.post_radius_m + usual.trunk_radius_m);
}

bool is_post_beyond_doubt(const Stem& stem, const UsualStems& usual) {
  return stem.upper_share >= kSureShare && stem.solidity >= kSureSolid && clearly_thicker(stem, usual);
}

// True for a stem that stands between two vines which are one vine spacing apart: it is not the vine itself.
bool is_extra(const std::vector<PlacedStem>& stems, std::size_t i, const UsualStems& usual) {
  if (!(usual.trunk_spacing_m > 0) || i == 0 || i + 1 >= stems.size()) return false;
  return stems[i + 1].chainage_m - stems[i - 1].chainage_m < 1.3 * usual.trunk_spacing_m;
}

// How well a stem would do as the post at a place: evidence of height, not thinner than posts are, near the place.
double fitness(const PlacedStem& s, double off_m, const UsualStems& usual) {
  const double thin = std::max(0.0, usual.post_radius_m - s.stem.radius_m) / 0.01;
  return std::min(2.0, evidence(s.stem)) - thin - 2 * off_m / kPlaceReachM;
}

std::optional<std::size_t> find_near(const std::vector<PlacedStem>& stems, double chainage_m, double reach_m,
                                     const UsualStems& usual) {
  constexpr double kTight = 0.15;  // m
  std::optional<std::size_t> best;
  double best_score = -4;  // a lone thin stem at the edge of the reach is worth less than an inferred post
  for (std::size_t i = 0; i < stems.size(); ++i) {
    const double off = std::abs(stems[i].chainage_m - chainage_m);
    const bool foot =
        is_extra(stems, i, usual) || (usual.thickness.tells_posts && usual.thickness.is_thick(stems[i].stem));
    const bool likely = maybe_post(stems[i].stem) || clearly_thicker(stems[i].stem, usual) || (off <= kTight && foot);
    if (off > reach_m || !likely) continue;
    const double score = fitness(stems[i], off, usual);
    if (score > best_score) best = i, best_score = score;
  }
  return best;
}

// The witness from which the spacing explains most of the others; nothing if that is less than half of them in a
// block whose posts do not stand regularly.
std::optional<std::size_t> find_anchor(const std::vector<PlacedStem>& stems, const std::vector<std::size_t>& witnesses,
                                       const UsualStems& usual) {
  std::optional<std::size_t> anchor;
  double best = 0;
  std::size_t best_count = 0;
  for (std::size_t a : witnesses) {
    double score = 0;
    std::size_t count = 0;
    for (std::size_t i : witnesses) {
      const double along = (stems[i].chainage_m - stems[a].chainage_m) / usual.spacing_m;
      const double off = std::abs(along - std::round(along));
      if (off > kOffPlace) continue;
      score += std::max(0.1, fitness(stems[i], 0, usual) + 1) * (1 - off / kOffPlace) + 0.1;
      ++count;
    }
    if (score > best) best = score, best_count = count, anchor = a;
  }
  if (!usual.regular && 2 * best_count < witnesses.size()) return std::nullopt;
  return anchor;
}

// Sure posts without regular spacing.
std::vector<std::size_t> irregular(const std::vector<PlacedStem>& stems, const std::vector<std::size_t>& sure,
                                   const UsualStems& usual) {
  const double closest = std::isfinite(usual.spacing_m) ? 0.5 * usual.spacing_m : 1.0;
  std::vector<std::size_t> posts;
  for (std::size_t i : sure) {
    if (posts.empty() || stems[i].chainage_m - stems[posts.back()].chainage_m >= closest) {
      posts.push_back(i);
    } else if (fitness(stems[i], 0, usual) > fitness(stems[posts.back()], 0, usual)) {
      posts.back() = i;
    }
  }
  return posts;
}

// The sure post where the canopy ends, though the spacing would not put one there: end panels are often shorter. Of a
// post and a vine beside it that is as high the one that fits better is it; both are posts where neither looks like a
// vine in anything.
void add_end_posts(const std::vector<PlacedStem>& stems, const std::vector<std::size_t>& sure, const UsualStems& usual,
                   double row_length_m, PostChoice& choice) {
  constexpr double kEnd = 1.0, kOnePost = 0.5;  // m
  const double apart = 0.25 * usual.spacing_m;
  const auto reach_of_post = [&](std::size_t a, std::size_t b) {
    return is_post_beyond_doubt(stems[a].stem, usual) && is_post_beyond_doubt(stems[b].stem, usual) ? kOnePost : apart;
  };
  const auto fit = [&](std::size_t i) { return fitness(stems[i], 0, usual); };
  for (const double end_m : {0.0, row_length_m}) {
    const auto is_at_end = [&](std::size_t i) { return std::abs(stems[i].chainage_m - end_m) <= kEnd; };
    std::optional<std::size_t> best;
    for (const std::size_t i : sure)
      if (is_at_end(i) && fit(i) >= (best ? fit(*best) : 0)) best = i;
    if (!best) continue;
    const double at = stems[*best].chainage_m;
    const bool taken = std::any_of(choice.posts.begin(), choice.posts.end(), [&](std::size_t k) {
      const double reach_m = reach_of_post(k, *best);
      return std::abs(stems[k].chainage_m - at) < reach_m || (reach_m == apart && is_at_end(k) && fit(k) >= fit(*best));
    });
    if (taken) continue;
    choice.posts.push_back(*best);
    std::erase_if(choice.inferred_m, [&](double m) { return std::abs(m - at) < apart; });
  }
}

}  // namespace

std::vector<std::size_t> sure_posts(const std::vector<PlacedStem>& stems) {
  std::vector<std::size_t> sure;
  for (std::size_t i = 0; i < stems.size(); ++i)
    if (stems[i].stem.upper_share >= kSureShare || stems[i].stem.solidity >= kSureSolid) sure.push_back(i);
  return sure;
}

std::vector<std::size_t> spacing_witnesses(const std::vector<PlacedStem>& stems, const std::vector<std::size_t>& sure,
                                           double trunk_spacing_m, const StemThickness& thickness) {
  UsualStems usual;
  usual.trunk_spacing_m = trunk_spacing_m;
  std::vector<std::size_t> witnesses;
  for (std::size_t i = 0; i < stems.size(); ++i) {
    const bool thick = thickness.tells_posts && thickness.is_thick(stems[i].stem);
    if (thick || std::binary_search(sure.begin(), sure.end(), i) || is_extra(stems, i, usual)) witnesses.push_back(i);
  }
  return witnesses;
}

PostChoice choose_posts(const std::vector<PlacedStem>& stems, const std::vector<std::size_t>& sure,
                        const std::vector<std::size_t>& witnesses, const UsualStems& usual, double row_length_m) {
  constexpr double kOverhang = 0.5;  // m; how far beyond the canopy a post may be wanted
  PostChoice choice;
  const std::optional<std::size_t> anchor =
      std::isfinite(usual.spacing_m) ? find_anchor(stems, witnesses, usual) : std::nullopt;
  if (!anchor) {
    choice.posts = irregular(stems, sure, usual);
    return choice;
  }
  const double reach = std::max(kPlaceReachM, kOffPlace * usual.spacing_m);
  choice.posts.push_back(*anchor);
  for (const double step : {usual.spacing_m, -usual.spacing_m}) {
    double at = stems[*anchor].chainage_m + step;
    for (; at > -kOverhang && at < row_length_m + kOverhang; at += step) {
      if (const auto found = find_near(stems, at, reach, usual)) {
        choice.posts.push_back(*found);
        at = stems[*found].chainage_m;
      } else {
        choice.inferred_m.push_back(at);
      }
    }
  }
  add_end_posts(stems, sure, usual, row_length_m, choice);
  std::sort(choice.posts.begin(), choice.posts.end());
  choice.posts.erase(std::unique(choice.posts.begin(), choice.posts.end()), choice.posts.end());
  std::sort(choice.inferred_m.begin(), choice.inferred_m.end());
  return choice;
}

}  // namespace rayfield::density
