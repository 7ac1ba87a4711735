#include "libdensity/posts/post_spacing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "rayfield/core/median.h"

namespace rayfield::density {
namespace {

// The sure posts that stand at multiples of the spacing from the one that explains most, itself with them: at each
// place the nearest, since a post and the vine beside it are one.
std::vector<std::size_t> most_on_lattice(const std::vector<PlacedStem>& stems, const std::vector<std::size_t>& sure,
                                         double spacing_m) {
  std::vector<std::size_t> most;
  for (std::size_t a : sure) {
    std::map<long, std::pair<double, std::size_t>> nearest;  // by place: how far off, and the stem
    for (std::size_t i : sure) {
      const double along = (stems[i].chainage_m - stems[a].chainage_m) / spacing_m;
      const long place = std::lround(along);
      const double off = std::abs(along - static_cast<double>(place));
      if (off > kOffPlace) continue;
      const auto [it, is_new] = nearest.try_emplace(place, off, i);
      if (!is_new && off < it->second.first) it->second = {off, i};
    }
    if (nearest.size() <= most.size()) continue;
    most.clear();
    for (const auto& [place, stem] : nearest) most.push_back(stem.second);
  }
  std::sort(most.begin(), most.end());
  return most;
}

// Whether the sure posts that only the narrower spacing explains are lower than those of the wider one: vines as tall
// as a post has to be. Posts whose upper part foliage hides are not held against them, nor end posts, which are taller
// than the rest, where the wider spacing has others.
bool added_are_lower(const std::vector<std::vector<PlacedStem>>& stems,
                     const std::vector<std::vector<std::size_t>>& sure, double narrow_m, double wide_m) {
  constexpr double kLowerM = 0.03;
  constexpr double kHiddenShare = 0.8;  // of the usual height; less than that is what foliage leaves to be seen
  std::vector<double> inner, ends;
  double added_m = 0;
  std::size_t added = 0;
  for (std::size_t r = 0; r < stems.size(); ++r) {
    const std::vector<std::size_t> wide = most_on_lattice(stems[r], sure[r], wide_m);
    for (const std::size_t i : most_on_lattice(stems[r], sure[r], narrow_m))
      if (std::binary_search(wide.begin(), wide.end(), i)) {
        (i == 0 || i + 1 == stems[r].size() ? ends : inner).push_back(stems[r][i].stem.top_m);
      } else {
        added_m += stems[r][i].stem.top_m, ++added;
      }
  }
  std::vector<double>& own = inner.empty() ? ends : inner;
  if (added == 0 || own.empty()) return false;
  const double usual_m = median_of(own);
  std::erase_if(own, [&](double top_m) { return top_m < kHiddenShare * usual_m; });
  return added_m / static_cast<double>(added) < median_of(own) - kLowerM;
}

// Places of a row's posts: chainages start + k·spacing, least squares.
class PlacesOfRow {
 public:
  PlacesOfRow(const std::vector<PlacedStem>& stems, const std::vector<std::size_t>& posts, double spacing_m) {
    double n = 0, k_sum = 0, kk_sum = 0, at_sum = 0, k_at_sum = 0;
    for (const std::size_t i : posts) {
      const double at = stems[i].chainage_m, k = std::round((at - stems[posts.front()].chainage_m) / spacing_m);
      n += 1, k_sum += k, kk_sum += k * k, at_sum += at, k_at_sum += k * at;
    }
    spacing_m_ = (n * k_at_sum - k_sum * at_sum) / (n * kk_sum - k_sum * k_sum);
    start_m_ = (at_sum - spacing_m_ * k_sum) / n;
  }
  /// How far a stem stands off the nearest place, with `parts` of them to a spacing.
  double off_m(double chainage_m, int parts) const {
    const double spacing_m = spacing_m_ / parts;
    return std::abs(std::remainder(chainage_m - start_m_, spacing_m));
  }

 private:
  double start_m_ = 0, spacing_m_ = 0;
};

// Whether the sure posts that only the narrower spacing explains stand off its places as those of the wider one do not:
// posts are set out, vines stand half-way between them by chance.
bool added_stand_off(const std::vector<std::vector<PlacedStem>>& stems,
                     const std::vector<std::vector<std::size_t>>& sure, double narrow_m, double wide_m) {
  constexpr std::size_t kLeastPosts = 3;  // of a row, to tell how far off they stand
  constexpr double kLeastOffM = 0.05, kTimesOff = 3;
  const int parts = static_cast<int>(std::lround(wide_m / narrow_m));
  std::vector<double> own_m, added_m;
  for (std::size_t r = 0; r < stems.size(); ++r) {
    const std::vector<std::size_t> wide = most_on_lattice(stems[r], sure[r], wide_m);
    if (wide.size() < kLeastPosts) continue;
    const PlacesOfRow places(stems[r], wide, wide_m);
    for (const std::size_t i : wide) own_m.push_back(places.off_m(stems[r][i].chainage_m, 1));
    for (const std::size_t i : most_on_lattice(stems[r], sure[r], narrow_m))
      if (!std::binary_search(wide.begin(), wide.end(), i))
        added_m.push_back(places.off_m(stems[r][i].chainage_m, parts));
  }
  return !added_m.empty() && median_of(added_m) > std::max(kLeastOffM, kTimesOff * median_of(own_m));
}

// Whether the sure posts that only the narrower spacing explains are thinner than those of the wider one, which are
// alike: vines. End posts are thicker than the rest and not asked.
bool added_are_thinner(const std::vector<std::vector<PlacedStem>>& stems,
                       const std::vector<std::vector<std::size_t>>& sure, double narrow_m, double wide_m) {
  constexpr std::size_t kLeastPosts = 3;
  constexpr double kLeastThinnerM = 0.004, kTimesSpread = 3, kMadToDeviation = 1.4826;
  std::vector<double> own_m, added_m, off_m;
  for (std::size_t r = 0; r < stems.size(); ++r) {
    const std::vector<std::size_t> wide = most_on_lattice(stems[r], sure[r], wide_m);
    for (const std::size_t i : most_on_lattice(stems[r], sure[r], narrow_m)) {
      if (i == 0 || i + 1 == stems[r].size()) continue;
      (std::binary_search(wide.begin(), wide.end(), i) ? own_m : added_m).push_back(stems[r][i].stem.radius_m);
    }
  }
  if (own_m.size() < kLeastPosts || added_m.empty()) return false;
  const double usual_m = median_of(own_m);
  for (const double radius_m : own_m) off_m.push_back(std::abs(radius_m - usual_m));
  return median_of(added_m) < usual_m - std::max(kLeastThinnerM, kTimesSpread * kMadToDeviation * median_of(off_m));
}

// How many places a spacing has in the rows, from the first sure post of each to the last.
std::size_t places_of(const std::vector<std::vector<PlacedStem>>& stems,
                      const std::vector<std::vector<std::size_t>>& sure, double spacing_m) {
  std::size_t places = 0;
  for (std::size_t r = 0; r < stems.size(); ++r) {
    if (sure[r].empty()) continue;
    const double length_m = stems[r][sure[r].back()].chainage_m - stems[r][sure[r].front()].chainage_m;
    places += 1 + static_cast<std::size_t>(std::lround(length_m / spacing_m));
  }
  return places;
}

// Distances between all pairs of sure posts of a row, not only neighbours: a vine taken for a post must not hide the
// gap between its neighbours.
std::vector<double> gaps_between_sure(const std::vector<std::vector<PlacedStem>>& stems,
                                      const std::vector<std::vector<std::size_t>>& sure, double min_m, double max_m) {
  std::vector<double> gaps;
  for (std::size_t r = 0; r < stems.size(); ++r)
    for (std::size_t i = 0; i < sure[r].size(); ++i)
      for (std::size_t j = i + 1; j < sure[r].size(); ++j) {
        const double gap = stems[r][sure[r][j]].chainage_m - stems[r][sure[r][i]].chainage_m;
        if (gap >= min_m && gap <= max_m) gaps.push_back(gap);
      }
  return gaps;
}

// How many sure posts stand at multiples of a spacing from the one of their row that explains most.
std::size_t explained_by(const std::vector<std::vector<PlacedStem>>& stems,
                         const std::vector<std::vector<std::size_t>>& sure, double spacing) {
  std::size_t sum = 0;
  for (std::size_t r = 0; r < stems.size(); ++r)
    if (!sure[r].empty()) sum += most_on_lattice(stems[r], sure[r], spacing).size() - 1;
  return sum;
}

struct SpacingCandidate {
  double spacing_m;
  std::size_t explained;
};

// Spacings that the gaps, their halves and their thirds suggest, ascending.
std::vector<SpacingCandidate> spacing_candidates(const std::vector<std::vector<PlacedStem>>& stems,
                                                 const std::vector<std::vector<std::size_t>>& sure,
                                                 std::span<const double> gaps, double min_m, double max_m) {
  std::vector<double> tried;
  for (double gap : gaps)
    for (int parts = 1; parts <= 3; ++parts)
      if (gap / parts >= min_m && gap / parts <= max_m) tried.push_back(gap / parts);
  std::sort(tried.begin(), tried.end());
  std::vector<SpacingCandidate> candidates;
  for (double spacing : tried) {
    constexpr double kApart = 0.005;  // m; a large block has more gaps than spacings that differ
    if (!candidates.empty() && spacing < candidates.back().spacing_m + kApart) continue;
    candidates.push_back({spacing, explained_by(stems, sure, spacing)});
  }
  return candidates;
}

// A half or a third of the spacing explains as much, and a little more by chance or by vines as tall as posts: of the
// multiples of the one that explains most, the widest that does nearly as well, or whose places are mostly taken, and
// twice as often as those that the narrower one adds, where the posts are lower, thinner or stand off. No other spacing
// may take its place.
SpacingCandidate widest_multiple(const std::vector<std::vector<PlacedStem>>& stems,
                                 const std::vector<std::vector<std::size_t>>& sure,
                                 std::span<const SpacingCandidate> candidates, std::size_t most, std::size_t others) {
  const std::size_t enough = most - std::min(most - 1, others / 20 + (most > 4 ? 1 : 0));
  double best = 0;
  for (const SpacingCandidate& c : candidates)
    if (c.explained == most) best = c.spacing_m;
  const auto rows = static_cast<std::size_t>(
      std::count_if(sure.begin(), sure.end(), [](const std::vector<std::size_t>& row) { return !row.empty(); }));
  const auto is_multiple = [](double spacing, double of) {
    const double times = spacing / of;
    return times > 1.5 && std::abs(times - std::round(times)) <= kOffPlace;
  };
  SpacingCandidate widest{best, most};
  for (const SpacingCandidate& c : candidates) {
    const std::size_t places = places_of(stems, sure, widest.spacing_m);
    const std::size_t own = std::min(places, places_of(stems, sure, c.spacing_m)), taken = c.explained + rows;
    const std::size_t others_taken = widest.explained - std::min(widest.explained, c.explained);
    const bool adds_little = 3 * taken > 2 * own && 2 * others_taken * own < taken * (places - own);
    if ((is_multiple(c.spacing_m, best) && c.explained >= enough) ||
        (is_multiple(c.spacing_m, widest.spacing_m) && adds_little &&
         (added_are_lower(stems, sure, widest.spacing_m, c.spacing_m) ||
          added_are_thinner(stems, sure, widest.spacing_m, c.spacing_m) ||
          added_stand_off(stems, sure, widest.spacing_m, c.spacing_m))))
      widest = c;
  }
  return widest;
}

// The radii of the stems at the places by which a spacing is split, how many such places there are, and the radii of
// what else is no witness.
struct SplitFeet {
  std::size_t places = 0;
  std::vector<double> at_places, elsewhere;
};

SplitFeet split_feet(const std::vector<std::vector<PlacedStem>>& stems,
                     const std::vector<std::vector<std::size_t>>& witnesses, double spacing_m, int parts) {
  SplitFeet out;
  for (std::size_t r = 0; r < stems.size(); ++r) {
    const std::vector<std::size_t> posts = most_on_lattice(stems[r], witnesses[r], spacing_m);
    if (posts.size() < 2) continue;
    std::vector<bool> used(stems[r].size(), false);
    const double first = stems[r][posts.front()].chainage_m, last = stems[r][posts.back()].chainage_m;
    const auto spans = static_cast<int>(std::lround((last - first) / spacing_m));
    for (int k = 1; k < spans * parts; ++k) {
      if (k % parts == 0) continue;
      ++out.places;
      const double at = first + (last - first) * k / (spans * parts);
      std::size_t nearest = 0;
      for (std::size_t i = 0; i < stems[r].size(); ++i)
        if (std::abs(stems[r][i].chainage_m - at) < std::abs(stems[r][nearest].chainage_m - at)) nearest = i;
      if (std::abs(stems[r][nearest].chainage_m - at) > kPlaceReachM || used[nearest]) continue;
      used[nearest] = true;
      out.at_places.push_back(stems[r][nearest].stem.radius_m);
    }
    for (std::size_t i = 0; i < stems[r].size(); ++i)
      if (!used[i] && !std::binary_search(witnesses[r].begin(), witnesses[r].end(), i))
        out.elsewhere.push_back(stems[r][i].stem.radius_m);
  }
  return out;
}

// Of nearly all pairs of a stem at a place and one elsewhere the one elsewhere is the thinner.
bool are_thicker(const SplitFeet& feet) {
  constexpr double kThicker = 0.9;
  double thinner = 0;
  for (const double radius_m : feet.at_places)
    thinner += static_cast<double>(std::count_if(feet.elsewhere.begin(), feet.elsewhere.end(),
                                                 [&](double other_m) { return other_m < radius_m; }));
  return thinner >= kThicker * static_cast<double>(feet.at_places.size() * feet.elsewhere.size());
}

// Rows without trunks to be seen: hardly any stem stands elsewhere, and those at the places are as thick as posts.
bool are_all_posts(const SplitFeet& feet, const std::vector<double>& post_radii_m) {
  constexpr double kAsThick = 0.85;
  return !post_radii_m.empty() && 2 * feet.elsewhere.size() <= feet.at_places.size() &&
         median_of(feet.at_places) >= kAsThick * median_of(post_radii_m);
}

// The radii of witnesses that do not stand at the end of a row, where posts are thicker.
std::vector<double> inner_radii(const std::vector<std::vector<PlacedStem>>& stems,
                                const std::vector<std::vector<std::size_t>>& witnesses) {
  std::vector<double> radii;
  for (std::size_t r = 0; r < stems.size(); ++r)
    for (const std::size_t i : witnesses[r])
      if (i > 0 && i + 1 < stems[r].size()) radii.push_back(stems[r][i].stem.radius_m);
  return radii;
}

}  // namespace

int parts_of_spacing(const std::vector<std::vector<PlacedStem>>& stems,
                     const std::vector<std::vector<std::size_t>>& witnesses, double spacing_m, double min_m) {
  constexpr std::size_t kLeastPlaces = 3, kLeastElsewhere = 10;
  constexpr double kTaken = 0.75;
  for (const int parts : {2, 3}) {
    if (!(spacing_m / parts >= min_m)) break;
    const SplitFeet feet = split_feet(stems, witnesses, spacing_m, parts);
    if (feet.places < kLeastPlaces ||
        static_cast<double>(feet.at_places.size()) < kTaken * static_cast<double>(feet.places))
      continue;
    const bool has_vines = feet.elsewhere.size() >= kLeastElsewhere;
    if (has_vines ? are_thicker(feet) : are_all_posts(feet, inner_radii(stems, witnesses))) return parts;
  }
  return 1;
}

// Of the spacings that pairs of sure posts suggest, the one that explains most posts, or a multiple of it that does
// nearly as well; then the median of the distances that agree with it.
UsualSpacing usual_spacing(const std::vector<std::vector<PlacedStem>>& stems,
                           const std::vector<std::vector<std::size_t>>& sure, double min_m, double max_m) {
  const std::vector<double> gaps = gaps_between_sure(stems, sure, min_m, 2 * max_m);
  std::size_t others = 0;
  for (const auto& of_row : sure) others += of_row.empty() ? 0 : of_row.size() - 1;
  const std::vector<SpacingCandidate> candidates = spacing_candidates(stems, sure, gaps, min_m, max_m);
  std::size_t most = 0;
  for (const SpacingCandidate& c : candidates) most = std::max(most, c.explained);
  if (most == 0) return {std::numeric_limits<double>::quiet_NaN(), false};
  const SpacingCandidate widest = widest_multiple(stems, sure, candidates, most, others);
  std::vector<double> spacings;
  for (double gap : gaps) {
    const double spacing = gap / std::max(1.0, std::round(gap / widest.spacing_m));
    if (std::abs(spacing - widest.spacing_m) <= kOffPlace * widest.spacing_m) spacings.push_back(spacing);
  }
  const double spacing = median_of(spacings);
  const std::size_t agree = explained_by(stems, sure, spacing);
  return {spacing, agree >= 4 && 2 * agree > others};
}

}  // namespace rayfield::density
