#include "libdensity/echoes/mixed_echoes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace rayfield::density {
namespace {

constexpr float kNarrowestM = 0.025F;                    // narrower beams are taken for such: rays are not so close
constexpr float kSameDirection = 0.998F;                 // cosine
constexpr float kOpposite = -0.5F;                       // cosine of the angle between neighbours, seen along the beam
constexpr float kPieceM = 0.16F;                         // of a beam, and
constexpr int kPiecesBefore = 3;                         // before the one with the echo, and as many behind: 0.56 m
constexpr float kBetweenFrom = 0.2F, kBetweenTo = 0.8F;  // of the gap
// The share of echoes between their neighbours: up to the range resolution, falling off as third leaves get in the way;
// behind it, of leaves that just stand there; and how gently it falls from one to the other.
constexpr std::array kWithin = {0.60, 0.65, 0.70};
constexpr std::array kFallsPerM = {0.0, 0.5, 1.0, 1.5, 2.0};
constexpr std::array kBeyond = {0.06, 0.12, 0.18, 0.24, 0.30};
constexpr double kGentlenessM = 0.015;
constexpr double kFinestM = 0.04, kStepM = 0.005;  // that are tried, so many
constexpr int kSteps = 83;
constexpr int kLeastGap = 4, kMostGap = 55;           // cm, that count
constexpr double kUsualM = 0.17, kUsualSpread = 0.4;  // median of lidars' resolutions, and how their logarithms differ
constexpr double kLateM = 0.022;  // fitted: of a spot a little deeper than the resolution hardly anything is missing

/// An echo near another one, seen along the other's beam.
struct Beside {
  Eigen::Vector3f across;  ///< unit vector from the beam
  float off = 0;           ///< from it, m
  float along = 0;         ///< beyond the echo, m
};

class Neighbours {
 public:
  explicit Neighbours(const EchoColumns& columns) : columns_(columns) {}

  /// Of the echo `i`: those before it and behind it.
  void look(std::size_t i) {
    const LeafEcho& echo = columns_.echoes()[i];
    const float reach_m = std::max(kNarrowestM, echo.width_m);
    const Eigen::Array3f box = box_around_beam(echo.direction, kPieceM / 2, reach_m);
    before_.clear(), behind_.clear();
    for (int piece = -kPiecesBefore; piece <= kPiecesBefore; ++piece) {
      const float middle = static_cast<float>(piece) * kPieceM;
      columns_.for_near(echo.position + middle * echo.direction, box, [&](std::size_t j) {
        const LeafEcho& other = columns_.echoes()[j];
        const Eigen::Vector3f to = other.position - echo.position;
        const float along = to.dot(echo.direction);
        if (j == i || along < middle - kPieceM / 2 || along >= middle + kPieceM / 2) return;
        if (other.direction.dot(echo.direction) <= kSameDirection) return;
        const Eigen::Vector3f across = to - along * echo.direction;
        const float off = across.norm();
        if (off > 0 && off < reach_m) (along < 0 ? before_ : behind_).push_back({across / off, off, along});
      });
    }
  }

  /// Counts the echo by the closest two on opposite sides.
  void count_in(MixedEchoes& mixed) const {
    float closest = std::numeric_limits<float>::infinity(), gap = 0, before = 0;
    for (const Beside& a : before_)
      for (const Beside& b : behind_) {
        if (a.off + b.off >= closest || a.across.dot(b.across) >= kOpposite) continue;
        closest = a.off + b.off, gap = b.along - a.along, before = -a.along;
      }
    const int bin = static_cast<int>(static_cast<double>(gap) / MixedEchoes::kGapStepM);
    if (!std::isfinite(closest) || bin >= MixedEchoes::kGaps) return;
    MixedEchoes::Count& count = mixed.gaps[static_cast<std::size_t>(bin)];
    ++count.all;
    if (before > kBetweenFrom * gap && before < kBetweenTo * gap) ++count.between;
  }

 private:
  const EchoColumns& columns_;
  std::vector<Beside> before_, behind_;
};

/// ln of the likelihood of the counts, where the share between is `within` at the least gap.
double ln_likelihood(const MixedEchoes& mixed, double resolution_m, double within, double falls, double beyond) {
  double sum = 0;
  for (int gap = kLeastGap; gap < kMostGap; ++gap) {
    const MixedEchoes::Count& count = mixed.gaps[static_cast<std::size_t>(gap)];
    const double gap_m = (gap + 0.5) * MixedEchoes::kGapStepM;
    const double top = std::max(beyond, within - falls * (gap_m - kLeastGap * MixedEchoes::kGapStepM));
    const double share = beyond + (top - beyond) / (1 + std::exp((gap_m - resolution_m) / kGentlenessM));
    sum += static_cast<double>(count.between) * std::log(share) +
           static_cast<double>(count.all - count.between) * std::log(1 - share);
  }
  return sum;
}

double best_ln_likelihood(const MixedEchoes& mixed, double resolution_m) {
  double best = -std::numeric_limits<double>::infinity();
  for (const double within : kWithin)
    for (const double falls : kFallsPerM)
      for (const double beyond : kBeyond)
        best = std::max(best, ln_likelihood(mixed, resolution_m, within, falls, beyond));
  return best;
}

}  // namespace

std::int64_t MixedEchoes::count() const {
  return std::accumulate(gaps.begin(), gaps.end(), std::int64_t{0},
                         [](std::int64_t sum, const Count& gap) { return sum + gap.all; });
}

MixedEchoes& MixedEchoes::operator+=(const MixedEchoes& other) {
  for (std::size_t i = 0; i < gaps.size(); ++i)
    gaps[i].all += other.gaps[i].all, gaps[i].between += other.gaps[i].between;
  return *this;
}

MixedEchoes find_mixed_echoes(const EchoColumns& echoes, std::size_t most) {
  const std::size_t count = echoes.echoes().size(),
                    step = std::max<std::size_t>(1, count / std::max<std::size_t>(1, most));
  MixedEchoes mixed;
  Neighbours neighbours(echoes);
  for (std::size_t i = 0; i < count; i += step) {
    neighbours.look(i);
    neighbours.count_in(mixed);
  }
  return mixed;
}

BelievedResolution range_resolution_of(const MixedEchoes& mixed) {
  std::vector<double> values_m, ln;
  for (int step = 0; step < kSteps; ++step) {
    const double apparent_m = kFinestM + kStepM * static_cast<double>(step), value_m = apparent_m - kLateM;
    if (value_m < kFinestM) continue;
    const double off = std::log(value_m / kUsualM) / kUsualSpread;
    values_m.push_back(value_m);
    ln.push_back(best_ln_likelihood(mixed, apparent_m) - off * off / 2 - std::log(value_m));
  }
  const auto best = std::max_element(ln.begin(), ln.end());
  const double value_m = values_m[static_cast<std::size_t>(best - ln.begin())];
  double weights = 0, squares = 0;
  for (std::size_t i = 0; i < ln.size(); ++i) {
    const double weight = std::exp(ln[i] - *best), off_m = values_m[i] - value_m;
    weights += weight, squares += weight * off_m * off_m;
  }
  return {value_m, std::sqrt(squares / weights)};
}

}  // namespace rayfield::density
