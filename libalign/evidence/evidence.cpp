#include "libalign/evidence/evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rayfield::align {
namespace {

constexpr double kIndexCell = 1.0;     // m; the largest radius of a match
constexpr double kMatchRadius = 0.25;  // m; what stands further apart is not the same post
constexpr double kRowReach = 0.75;     // m; of a row around its centreline
constexpr double kCorridor = 0.7;      // m; width around a row's centreline in which uprights are found

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

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
  return 1 / (kCorridor * std::max(0.3, median(gaps)));
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

// Standard deviation per axis of distances in plan, those beyond three times the median left out; a Rayleigh
// distribution has a mean square of 2 σ².
double spread_of(std::vector<double> distances, double least, double largest) {
  if (distances.empty()) return largest;
  const double bound = 3 * median(distances);
  double sum = 0, count = 0;
  for (const double d : distances)
    if (d <= bound) sum += d * d, ++count;
  return std::clamp(std::sqrt(0.5 * sum / count), least, largest);
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
  agreement.offset_m = median(differences);
  for (double& d : differences) d = std::abs(d - agreement.offset_m);
  agreement.deviation_m = median(differences);
  return agreement;
}

// Uprights. Posts and vines stand in a lattice, so that a shift by a panel lays most of them on others: what tells the
// places apart is where rows end, how well each upright fits, and, little, which ones are seen.
//  - Where both have a row, an upright is seen by the other with probability kSeen; one that is not stood at as
//    predictable a place as those that are, as long as there are no more of them. Its place has the density of a normal
//    distribution with the hypothesis's own spread σ, on average 1 / (2π·e·σ²).
//  - Where the other scan looked and has no row, an upright is a ghost (kGhost), anywhere in its strip (density u).
//  - What only one scan looked at says nothing: density u.
// Ground: as many independent heights as patches, normal with the hypothesis's own spread.
// Prior: the shift between two positions by GPS, and the turn that follows from them; beyond eight standard deviations
// all turns are gross mistakes, and alike.
Evidence weigh(const LandmarkPair& pair, const PlanShift& shift, const SearchOptions& options) {
  constexpr double kSeen = 0.62, kGhost = 0.02, kGrossTurn = 8;
  constexpr double kLeastSigma = 0.008, kLargestSigma = 0.10;          // m, of a match per axis
  constexpr double kPatch = 25, kLeastGround = 0.015, kGround = 0.10;  // m², m, m
  Evidence e;
  const std::vector<Match> matches = match_uprights(pair, shift, kMatchRadius);
  const double log_u = std::log(upright_density(pair.scan));
  std::vector<double> distances;
  std::vector<bool> scan_matched(pair.scan.uprights.size()), reference_matched(pair.reference.uprights.size());
  for (const Match& m : matches) {
    distances.push_back(m.distance_m);
    scan_matched[static_cast<std::size_t>(m.scan)] = reference_matched[static_cast<std::size_t>(m.reference)] = true;
    e.log_uprights += log_radius(pair.scan.uprights[static_cast<std::size_t>(m.scan)],
                                 pair.reference.uprights[static_cast<std::size_t>(m.reference)]);
  }
  e.matched = static_cast<int>(matches.size());
  e.residual_m = distances.empty() ? std::numeric_limits<double>::quiet_NaN() : median(distances);
  const double sigma = spread_of(distances, kLeastSigma, kLargestSigma);

  int hidden = 0;  // in a row of both, seen by one
  for (std::size_t i = 0; i < scan_matched.size(); ++i) {
    const Eigen::Vector2d p = shift * pair.scan.uprights[i].position;
    if (scan_matched[i]) continue;
    if (pair.reference_rows.contains(p)) {
      ++hidden;
    } else if (pair.reference_cover.contains(p)) {
      ++e.beyond;
    }
  }
  const int predictable = std::min(hidden, e.matched);
  const double log_place = -std::log(2 * std::numbers::pi * sigma * sigma) - 1 - log_u;
  e.log_uprights += e.matched * (log_place + 2 * std::log(kSeen));
  e.log_uprights += predictable * log_place + hidden * std::log(1 - kSeen);
  e.shared = 2 * e.matched + hidden + e.beyond;
  const PlanShift back = inverse(shift);
  int missing = 0, missing_beyond = 0;
  for (std::size_t i = 0; i < reference_matched.size(); ++i) {
    const Eigen::Vector2d p = back * pair.reference.uprights[i].position;
    if (reference_matched[i]) continue;
    if (pair.scan_rows.contains(p)) {
      ++missing;
    } else if (pair.scan_cover.contains(p)) {
      ++missing_beyond;
    }
  }
  e.log_uprights += missing * std::log(1 - kSeen) + (e.beyond + missing_beyond) * std::log(kGhost);
  e.shared += missing + missing_beyond;
  e.beyond += missing_beyond;

  e.ground = compare_ground(pair, shift);
  if (e.ground.area_m2 > 0)
    e.log_ground = e.ground.area_m2 / kPatch * std::log(kGround / std::max(1.48 * e.ground.deviation_m, kLeastGround));

  const double turn = std::remainder(shift.yaw_rad, 2 * std::numbers::pi) / options.yaw_sigma_rad;
  e.log_prior = -0.5 * shift.shift.head<2>().squaredNorm() / (options.gps_sigma_m * options.gps_sigma_m) -
                0.5 * std::min(turn * turn, kGrossTurn * kGrossTurn);
  return e;
}

}  // namespace rayfield::align
