#include "libdensity/posts/post_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "rayfield/core/median.h"

namespace rayfield::density {
namespace {

// The witnesses that stand at multiples of the spacing from the one that explains most, itself with them: at each
// place the nearest, since a post and the vine beside it are one.
std::vector<std::size_t> most_on_lattice(const std::vector<PlacedStem>& stems,
                                         const std::vector<std::size_t>& witnesses, double spacing_m) {
  std::vector<std::size_t> most;
  for (std::size_t a : witnesses) {
    std::map<long, std::pair<double, std::size_t>> nearest;  // by place: how far off, and the stem
    for (std::size_t i : witnesses) {
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

// Distances between all pairs of witnesses of a row, not only neighbours: a vine taken for a post must not hide the
// gap between its neighbours.
std::vector<double> gaps_between(const std::vector<std::vector<PlacedStem>>& stems,
                                 const std::vector<std::vector<std::size_t>>& witnesses, double min_m, double max_m) {
  std::vector<double> gaps;
  for (std::size_t r = 0; r < stems.size(); ++r)
    for (std::size_t i = 0; i < witnesses[r].size(); ++i)
      for (std::size_t j = i + 1; j < witnesses[r].size(); ++j) {
        const double gap = stems[r][witnesses[r][j]].chainage_m - stems[r][witnesses[r][i]].chainage_m;
        if (gap >= min_m && gap <= max_m) gaps.push_back(gap);
      }
  return gaps;
}

// How many witnesses stand at multiples of a spacing from the one of their row that explains most.
std::size_t explained_by(const std::vector<std::vector<PlacedStem>>& stems,
                         const std::vector<std::vector<std::size_t>>& witnesses, double spacing) {
  std::size_t sum = 0;
  for (std::size_t r = 0; r < stems.size(); ++r)
    if (!witnesses[r].empty()) sum += most_on_lattice(stems[r], witnesses[r], spacing).size() - 1;
  return sum;
}

// What stands at a place of a spacing, or elsewhere in a row: nothing, or a stem that is a witness of the spacing or
// not, thicker than vines mostly are or not. A place without a stem and one with a vine are the same: no post.
enum Standing : std::size_t { kNoPost, kThickFoot, kWitness, kThickWitness, kStandings };
using StandingCounts = std::array<double, kStandings>;

// Posts at the ends of rows are thicker than the others and stand at the places of any part of a row's length: they are
// not asked how thick they are.
Standing standing_of(const Stem& stem, bool is_witness, bool is_end, const StemThickness& thickness) {
  const bool is_thick = !is_end && thickness.is_rather_thick(stem);
  if (is_witness) return is_thick ? kThickWitness : kWitness;
  return is_thick ? kThickFoot : kNoPost;
}

// A row as its spacing is judged by it.
struct RowStandings {
  std::vector<Standing> of_stem;
  StandingCounts all{};  // where stems stand, and each metre without one, where one might
};

RowStandings row_standings(const std::vector<PlacedStem>& stems, const std::vector<std::size_t>& witnesses,
                           const StemThickness& thickness) {
  constexpr double kOpenM = 1.0;
  RowStandings row;
  for (std::size_t i = 0; i < stems.size(); ++i) {
    const bool is_witness = std::binary_search(witnesses.begin(), witnesses.end(), i);
    const bool is_end = i == 0 || i + 1 == stems.size();
    row.of_stem.push_back(standing_of(stems[i].stem, is_witness, is_end, thickness));
    ++row.all[row.of_stem.back()];
    if (i == 0) continue;
    const double open = std::round((stems[i].chainage_m - stems[i - 1].chainage_m) / kOpenM) - 1;
    row.all[kNoPost] += std::max(0.0, open);
  }
  return row;
}

// The stem nearest to a chainage within `reach_m`; `stems.size()` without one.
std::size_t nearest_stem(const std::vector<PlacedStem>& stems, double chainage_m, double reach_m) {
  const auto from = std::lower_bound(stems.begin(), stems.end(), chainage_m - reach_m,
                                     [](const PlacedStem& s, double at_m) { return s.chainage_m < at_m; });
  std::size_t nearest = stems.size();
  for (auto it = from; it != stems.end() && it->chainage_m <= chainage_m + reach_m; ++it) {
    const auto i = static_cast<std::size_t>(it - stems.begin());
    if (nearest == stems.size() ||
        std::abs(it->chainage_m - chainage_m) < std::abs(stems[nearest].chainage_m - chainage_m))
      nearest = i;
  }
  return nearest;
}

// What stands at the places of a spacing from the row's first stem to its last. `posts`, the witnesses that stand at
// places, say where the others are.
StandingCounts count_at_places(const std::vector<PlacedStem>& stems, const RowStandings& row,
                               const std::vector<std::size_t>& posts, double spacing_m) {
  StandingCounts at{};
  const double reach_m = kOffPlace * spacing_m;
  const double start_m = stems[posts.front()].chainage_m;
  double place_m = start_m - spacing_m * std::floor((start_m - stems.front().chainage_m + reach_m) / spacing_m);
  std::size_t next = 0;
  while (place_m <= stems.back().chainage_m + reach_m) {
    while (next < posts.size() && stems[posts[next]].chainage_m < place_m - 0.5 * spacing_m) ++next;
    if (next < posts.size() && stems[posts[next]].chainage_m < place_m + 0.5 * spacing_m) {
      place_m = stems[posts[next]].chainage_m;
      ++at[row.of_stem[posts[next]]];
    } else {
      const std::size_t stem = nearest_stem(stems, place_m, std::min(kPlaceReachM, reach_m));
      ++at[stem == stems.size() ? kNoPost : row.of_stem[stem]];
    }
    place_m += spacing_m;
  }
  return at;
}

// ln likelihood of counts, each with its own share of them.
double log_likelihood(const StandingCounts& counts) {
  double sum = 0, total = 0;
  for (const double n : counts)
    if (n > 0) sum += n * std::log(n), total += n;
  return total > 0 ? sum - total * std::log(total) : 0;
}

// How much likelier what stands in the rows is if it is another at the places of a spacing than elsewhere, as ln of the
// ratio (half of the G statistic of the table of counts). Half of the right spacing has places without posts, twice of
// it leaves posts elsewhere, and where canes make vines as high as posts, such stand everywhere: each makes the places
// and the rest more alike.
double evidence_for(const std::vector<std::vector<PlacedStem>>& stems,
                    const std::vector<std::vector<std::size_t>>& witnesses, const std::vector<RowStandings>& rows,
                    double spacing_m) {
  StandingCounts at{}, elsewhere{}, all{};
  for (std::size_t r = 0; r < stems.size(); ++r) {
    const std::vector<std::size_t> posts = most_on_lattice(stems[r], witnesses[r], spacing_m);
    const StandingCounts at_row =
        posts.empty() ? StandingCounts{} : count_at_places(stems[r], rows[r], posts, spacing_m);
    for (std::size_t k = 0; k < kStandings; ++k) {
      at[k] += at_row[k];
      elsewhere[k] += std::max(0.0, rows[r].all[k] - at_row[k]);
    }
  }
  for (std::size_t k = 0; k < kStandings; ++k) all[k] = at[k] + elsewhere[k];
  return log_likelihood(at) + log_likelihood(elsewhere) - log_likelihood(all);
}

// Spacings that the gaps, their halves and their thirds suggest, ascending.
std::vector<double> suggested_spacings(std::span<const double> gaps, double min_m, double max_m) {
  constexpr double kApartM = 0.005;  // a large block has more gaps than spacings that differ
  std::vector<double> tried, kept;
  for (const double gap : gaps)
    for (int parts = 1; parts <= 3; ++parts)
      if (gap / parts >= min_m && gap / parts <= max_m) tried.push_back(gap / parts);
  std::sort(tried.begin(), tried.end());
  for (const double spacing_m : tried)
    if (kept.empty() || spacing_m >= kept.back() + kApartM) kept.push_back(spacing_m);
  return kept;
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

// Of the spacings that pairs of witnesses suggest, the one with the most evidence; then the median of the distances
// that agree with it.
UsualSpacing usual_spacing(const std::vector<std::vector<PlacedStem>>& stems,
                           const std::vector<std::vector<std::size_t>>& witnesses, const StemThickness& thickness,
                           double min_m, double max_m) {
  constexpr double kLeastEvidence = 10;  // in ln
  const std::vector<double> gaps = gaps_between(stems, witnesses, min_m, 2 * max_m);
  std::vector<RowStandings> rows;
  std::size_t others = 0;
  for (std::size_t r = 0; r < stems.size(); ++r) {
    rows.push_back(row_standings(stems[r], witnesses[r], thickness));
    others += witnesses[r].empty() ? 0 : witnesses[r].size() - 1;
  }
  double best_m = std::numeric_limits<double>::quiet_NaN(), most = 0;
  for (const double spacing_m : suggested_spacings(gaps, min_m, max_m)) {
    const double evidence = evidence_for(stems, witnesses, rows, spacing_m);
    if (std::isnan(best_m) || evidence >= most) best_m = spacing_m, most = evidence;
  }
  if (std::isnan(best_m)) return {best_m, false};
  std::vector<double> spacings;
  for (const double gap : gaps) {
    const double spacing = gap / std::max(1.0, std::round(gap / best_m));
    if (std::abs(spacing - best_m) <= kOffPlace * best_m) spacings.push_back(spacing);
  }
  const double spacing = median_of(spacings);
  const std::size_t agree = explained_by(stems, witnesses, spacing);
  return {spacing, agree >= 4 && (2 * agree > others || most >= kLeastEvidence)};
}

}  // namespace rayfield::density
