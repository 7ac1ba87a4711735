#include "libalign/evidence/evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "rayfield/core/median.h"

namespace rayfield::align {
namespace {

constexpr double kIndexCell = 1.0;  // m; the largest radius of a match
constexpr double kRowReach = 0.75;  // m; of a row around its centreline
constexpr double kCorridor = 0.7;   // m; width around a row's centreline in which uprights are found

PlanShift inverse(const PlanShift& s) {
  PlanShift back;
  back.pivot = s.pivot + s.shift.head<2>();
  back.shift = -s.shift;
  back.yaw_rad = -s.yaw_rad;
  return back;
}

// Uprights per m² of the strips in which they are found.
double upright_density(const BlockLandmarks& landmarks) {
  if (landmarks.uprights.size() < 2) return 1;
  std::vector<double> gaps;
  for (const Upright& a : landmarks.uprights) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Upright& b : landmarks.uprights)
      if (&a != &b) nearest = std::min(nearest, (a.position - b.position).squaredNorm());
    gaps.push_back(std::sqrt(nearest));
    if (gaps.size() >= 200) break;
  }
  return 1 / (kCorridor * std::max(0.3, median_of(gaps)));
}

std::vector<Eigen::Vector2d> vertices_of(const BlockLandmarks& landmarks) {
  std::vector<Eigen::Vector2d> all;
  for (const auto& row : landmarks.rows) all.insert(all.end(), row.begin(), row.end());
  return all;
}

// Likelihood of two radii being of the same upright against two of the block: Student's t with the spread of radii.
double log_radius(const Upright& a, const Upright& b) {
  constexpr double kSigma = 0.008;  // m
  const double t = (a.radius_m - b.radius_m) / kSigma;
  return std::max(-2.0, 0.5 - std::log1p(t * t / 3));
}

// Uprights of one scan without a partner in the other.
struct Unmatched {
  int hidden = 0;  // where the other has a row
  int beyond = 0;  // where it looked and has none
};

// `shift` lays the uprights on the other scan, whose rows and cover are given.
Unmatched count_unmatched(const std::vector<Upright>& uprights, const std::vector<bool>& matched,
                          const PlanShift& shift, const Cover& rows, const Cover& cover) {
  Unmatched counts;
  for (std::size_t i = 0; i < uprights.size(); ++i) {
    if (matched[i]) continue;
    const Eigen::Vector2d p = shift * uprights[i].position;
    if (rows.contains(p)) {
      ++counts.hidden;
    } else if (cover.contains(p)) {
      ++counts.beyond;
    }
  }
  return counts;
}

// Posts and vines stand in a lattice, so that a shift by a panel lays most of them on others: what tells the places
// apart is where rows end, how well each upright fits, and, little, which ones are seen.
//  - Where both have a row, an upright is seen by the other with probability kSeen; one that is not stood at as
//    predictable a place as those that are, as long as there are no more of them. Its place has the density of a normal
//    distribution with the hypothesis's own spread σ, on average 1 / (2π·e·σ²).
//  - Where the other scan looked and has no row, an upright is a ghost (kGhost), anywhere in its strip (density u).
//  - What only one scan looked at says nothing: density u.
void weigh_uprights(const LandmarkPair& pair, const PlanShift& shift, Evidence& e) {
  constexpr double kSeen = 0.62, kGhost = 0.02;
  constexpr double kLeastSigma = 0.008, kLargestSigma = 0.10;  // m, of a match per axis
  std::vector<double> distances;
  std::vector<bool> scan_matched(pair.scan.uprights.size()), reference_matched(pair.reference.uprights.size());
  for (const Match& m : match_uprights(pair, shift, kMatchRadius_m)) {
    const auto scan = static_cast<std::size_t>(m.scan), reference = static_cast<std::size_t>(m.reference);
    distances.push_back(m.distance_m);
    scan_matched[scan] = reference_matched[reference] = true;
    e.log_uprights += log_radius(pair.scan.uprights[scan], pair.reference.uprights[reference]);
  }
  const Unmatched of_scan =
      count_unmatched(pair.scan.uprights, scan_matched, shift, pair.reference_rows, pair.reference_cover);
  const Unmatched of_reference =
      count_unmatched(pair.reference.uprights, reference_matched, inverse(shift), pair.scan_rows, pair.scan_cover);
  e.matched = static_cast<int>(distances.size());
  e.residual_m = median_of(distances);
  e.beyond = of_scan.beyond + of_reference.beyond;
  e.shared = 2 * e.matched + of_scan.hidden + of_reference.hidden + e.beyond;

  // Distances in plan have a Rayleigh distribution, whose mean square is 2 σ².
  const double sigma = distances.empty()
                           ? kLargestSigma
                           : std::clamp(std::sqrt(0.5 * trimmed_mean_square(distances)), kLeastSigma, kLargestSigma);
  const double log_place = -std::log(2 * std::numbers::pi * sigma * sigma) - 1 - std::log(pair.uprights_per_m2);
  e.log_uprights += e.matched * (log_place + 2 * std::log(kSeen));
  e.log_uprights += std::min(of_scan.hidden, e.matched) * log_place + of_scan.hidden * std::log(1 - kSeen);
  e.log_uprights += of_reference.hidden * std::log(1 - kSeen) + e.beyond * std::log(kGhost);
}

}  // namespace

LandmarkPair::LandmarkPair(const BlockLandmarks& reference_landmarks, const BlockLandmarks& scan_landmarks,
                           double reach_m)
    : reference(reference_landmarks),
      scan(scan_landmarks),
      index(reference_landmarks.uprights, kIndexCell),
      reference_cover(reference_landmarks.path, reach_m),
      scan_cover(scan_landmarks.path, reach_m),
      reference_rows(vertices_of(reference_landmarks), kRowReach),
      scan_rows(vertices_of(scan_landmarks), kRowReach) {
  uprights_per_m2 = upright_density(scan);
  for (const Upright& u : scan.uprights) pivot += u.position / static_cast<double>(scan.uprights.size());
}

std::vector<Match> match_uprights(const LandmarkPair& pair, const PlanShift& shift, double radius_m) {
  std::vector<Match> matches;
  std::vector<int> taken(pair.reference.uprights.size(), -1);
  for (std::size_t i = 0; i < pair.scan.uprights.size(); ++i) {
    const Eigen::Vector2d p = shift * pair.scan.uprights[i].position;
    const int r = pair.index.nearest(p, radius_m);
    if (r < 0) continue;
    const double distance = (pair.reference.uprights[static_cast<std::size_t>(r)].position - p).norm();
    int& at = taken[static_cast<std::size_t>(r)];
    const Match match{static_cast<int>(i), r, distance};
    if (at < 0) {
      at = static_cast<int>(matches.size());
      matches.push_back(match);
    } else if (distance < matches[static_cast<std::size_t>(at)].distance_m) {
      matches[static_cast<std::size_t>(at)] = match;
    }
  }
  std::sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.scan < b.scan; });
  return matches;
}

double trimmed_mean_square(std::span<const double> distances) {
  const double bound = 3 * median_of({distances.begin(), distances.end()});
  double sum = 0, count = 0;
  for (const double d : distances)
    if (d <= bound) sum += d * d, ++count;
  return sum / count;
}

GroundAgreement compare_ground(const LandmarkPair& pair, const PlanShift& shift) {
  const Grid2<float>& from = pair.scan.ground;
  const Grid2<float>& to = pair.reference.ground;
  std::vector<double> differences;
  for (int iy = 0; iy < from.ny; ++iy)
    for (int ix = 0; ix < from.nx; ++ix) {
      const double height = static_cast<double>(from.at(ix, iy));
      if (!std::isfinite(height)) continue;
      // Bilinear between the middles of four cells.
      const Eigen::Vector2d at = (shift * from.center(ix, iy) - to.origin) / to.cell_m - Eigen::Vector2d(0.5, 0.5);
      const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
      if (!to.contains(x, y) || !to.contains(x + 1, y + 1)) continue;
      const double fx = at.x() - x, fy = at.y() - y;
      const auto value = [&](int dx, int dy) { return static_cast<double>(to.at(x + dx, y + dy)); };
      const double there =
          (1 - fy) * ((1 - fx) * value(0, 0) + fx * value(1, 0)) + fy * ((1 - fx) * value(0, 1) + fx * value(1, 1));
      if (std::isfinite(there)) differences.push_back(there - height);
    }
  GroundAgreement agreement;
  agreement.area_m2 = static_cast<double>(differences.size()) * from.cell_m * from.cell_m;
  agreement.deviation_m = std::numeric_limits<double>::quiet_NaN();
  if (differences.empty()) return agreement;
  agreement.offset_m = median_of(differences);
  for (double& d : differences) d = std::abs(d - agreement.offset_m);
  agreement.deviation_m = median_of(differences);
  return agreement;
}

// Uprights: see weigh_uprights().
// Ground: as many independent heights as patches, normal with the hypothesis's own spread.
// Prior: the shift between two positions by GPS, and the turn that follows from them; beyond eight standard deviations
// all turns are gross mistakes, and alike.
Evidence weigh(const LandmarkPair& pair, const PlanShift& shift, const SearchOptions& options) {
  constexpr double kPatch = 25, kLeastGround = 0.015, kGround = 0.10;  // m², m, m
  constexpr double kGrossTurn = 8;
  Evidence e;
  weigh_uprights(pair, shift, e);

  e.ground = compare_ground(pair, shift);
  if (e.ground.area_m2 > 0)
    e.log_ground = e.ground.area_m2 / kPatch * std::log(kGround / std::max(1.48 * e.ground.deviation_m, kLeastGround));

  const double turn = std::remainder(shift.yaw_rad, 2 * std::numbers::pi) / options.yaw_sigma_rad;
  e.log_prior = -0.5 * shift.shift.head<2>().squaredNorm() / (options.gps_sigma_m * options.gps_sigma_m) -
                0.5 * std::min(turn * turn, kGrossTurn * kGrossTurn);
  return e;
}

}  // namespace rayfield::align
