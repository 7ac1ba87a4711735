#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libdensity/echoes/full_echoes.h"
#include "libdensity/echoes/leaf_size.h"
#include "libdensity/echoes/mixed_echoes.h"

namespace rayfield::density {

/// How strong the echoes of a scan's leaves are, by the width of the beam where they came from. Integers: any split of
/// the echoes gives the same sums.
class EchoStatistics {
 public:
  static constexpr int kWidthBins = 80;
  static constexpr double kWidthStepM = 0.002;
  static constexpr int kIntensities = 1 << 16;
  static constexpr int kLevels = 128;  ///< of intensity, eight to a doubling

  struct Sum {
    std::int64_t count = 0, intensity = 0;
    void add(std::int64_t n, std::int64_t of_intensity) { count += n, intensity += of_intensity; }
    double mean() const { return count > 0 ? static_cast<double>(intensity) / static_cast<double>(count) : 0; }
    bool operator==(const Sum&) const = default;
  };

  /// Where a beam ended on a known post or trunk.
  struct OnStem {
    bool of_trunk = false;
    bool is_full = false;     ///< the beam fell wholly on it
    bool above_grass = true;  ///< what grows at its foot is not in the echo
  };
  /// Echoes on known posts, or on known trunks.
  struct Stems {
    Sum full;                              ///< of beams that fell wholly on one
    std::vector<std::uint32_t> histogram;  ///< of all above grass: [intensity], number of echoes
    Stems() : histogram(kIntensities, 0) {}
    void merge(const Stems& other);
    bool operator==(const Stems&) const = default;
  };

  EchoStatistics();

  /// An echo on a leaf of a beam that is `width_m` wide there.
  void add_echo(std::uint16_t intensity, double width_m);
  /// Those of them of beams that fell wholly on a leaf.
  void add_full_echoes(std::span<const FullEcho> echoes) { full_.insert(full_.end(), echoes.begin(), echoes.end()); }
  /// Those of them with neighbours before and behind them.
  void add_mixed_echoes(const MixedEchoes& echoes) { mixed_ += echoes; }
  /// An echo of the ground, by the cosine of the beam to the ground's normal.
  void add_ground_echo(std::uint16_t intensity, double cosine);
  /// An echo on a known post or trunk.
  void add_stem_echo(std::uint16_t intensity, const OnStem& place);
  /// A pair of neighbouring beams (LeafSizePairs::add); `second`: intensity of the next ray's echo, if it `hit`.
  void add_pair(std::uint16_t first, std::uint16_t second, double distance_m, double delta_m, bool hit);
  /// That one beam turned from one ray of such a pair to the other, which went past within 4 cm.
  void add_same_beam_beside() { ++same_beam_beside_; }
  void merge(const EchoStatistics& other);

  std::uint64_t echoes() const;
  /// [bin of width]
  const std::array<Sum, kWidthBins>& all() const { return all_; }
  std::span<const FullEcho> full() const { return full_; }
  const MixedEchoes& mixed() const { return mixed_; }
  /// How the ground's echoes depend on the angle, with an error for leaves' doing otherwise; the belief of those who
  /// have not looked where the ground is not seen both steeply and aslant.
  AngleDependence ground_dependence() const;
  const Stems& posts() const { return posts_; }
  const Stems& trunks() const { return trunks_; }
  /// Echoes of beams that fell wholly on known posts and trunks.
  Sum wood() const;
  /// Of lidars with one beam most echoes have one, of lidars with several at a time few.
  std::uint64_t same_beam_beside() const { return same_beam_beside_; }
  /// [intensity]: number of echoes
  const std::vector<std::uint32_t>& histogram() const { return histogram_; }
  /// Pairs of which only echoes of at least so much count: weaker ones lie at edges, where the middle of the beam goes
  /// past.
  LeafSizePairs pairs_from(double intensity) const;
  bool operator==(const EchoStatistics&) const = default;

 private:
  static constexpr int kCosines = 20;
  std::array<Sum, kWidthBins> all_{};
  std::array<Sum, kCosines> ground_{};  // [bin of the cosine]
  std::vector<FullEcho> full_;
  MixedEchoes mixed_;
  Stems posts_, trunks_;
  std::uint64_t same_beam_beside_ = 0;
  std::vector<std::uint32_t> histogram_;
  std::vector<LeafSizePairs> pairs_;  // [level]: rays by the level of the first echo, ends by the weaker one's
};

/// Intensity that a share of the echoes of a histogram does not reach; whole numbers stand for a unit. 0 of none.
double strength_quantile(std::span<const std::uint32_t> histogram, double share);

}  // namespace rayfield::density
