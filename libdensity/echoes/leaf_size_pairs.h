#pragma once

#include <array>
#include <cstdint>

namespace rayfield::density {

/// What neighbouring beams say about the size of the leaves (docs/density.md, "How large is a leaf").
///
/// For every hit in a voxel, the ray beside it (BeamNeighbours) passes at some distance r. Seen from there, with Δ =
/// range of that ray − distance at which it passes the hit, counts of where those rays end, by r in steps of kStepM and
/// by Δ in steps of kDepthStepM, from −kReachM to kReachM. Rays that ended before never came near and are not counted.
struct LeafSizePairs {
  static constexpr int kBins = 16;
  static constexpr double kStepM = 0.005;
  static constexpr double kCloseM = 0.04;  ///< up to here most pairs are of one leaf
  static constexpr int kDepths = 40;
  static constexpr double kDepthStepM = 0.01, kReachM = kDepths * kDepthStepM / 2;
  using Depths = std::array<std::uint64_t, kDepths>;
  /// [r][Δ]: of all rays, and in `beyond` those that go on.
  std::array<Depths, kBins> rays{};
  std::array<std::uint64_t, kBins> beyond{};
  /// [r][Δ]: of rays whose echo counts. The others that end are taken to have gone past.
  std::array<Depths, kBins> ends{};

  LeafSizePairs& operator+=(const LeafSizePairs& other);
  bool operator==(const LeafSizePairs&) const = default;
  /// One pair: the next ray passes at `distance_m`, and ends `delta_m` beyond it (`hit`), or goes on at least that far.
  void add(double distance_m, double delta_m, bool hit) { add(distance_m, delta_m, hit, *this); }
  /// The same, with the ray counted here and where it ends in `echoes`.
  void add(double distance_m, double delta_m, bool hit, LeafSizePairs& echoes);
};

/// Depths that are looked at together, and what they hold.
struct PairWindows {
  double window_m = 0.05;  ///< w, whole steps of Δ: leaf tilt at r ≤ 4 cm and the ranges' noise stay mostly inside
  double range_noise_m = 0.012;                ///< standard deviation of one range
  double farthest_m = LeafSizePairs::kCloseM;  ///< r, where there are enough pairs up to there
};

/// Pairs by r: rays that come near (Δ ≥ −2w), and those that end in front (−2w ≤ Δ < −w), at the same depth (|Δ| < w)
/// and behind (w ≤ Δ < 2w).
struct PairCounts {
  using Counts = std::array<std::uint64_t, LeafSizePairs::kBins>;
  Counts near{}, front{}, same{}, behind{};
};
inline constexpr PairWindows kUsualWindows;

/// How dense leaves stand around leaves: of rays that pass within 4 cm of a hit and go on for 5 cm behind it, how many
/// end in the 10 cm from there on, per metre. `otherwise`, what is usual of leaves, where there are fewer than 200.
double ends_per_metre_behind(const LeafSizePairs& pairs, double otherwise = 2.5);

PairCounts counts_of(const LeafSizePairs& pairs, double window_m);

}  // namespace rayfield::density
