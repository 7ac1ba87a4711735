#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "libdensity/echoes/leaf_angle.h"
#include "libdensity/leaf_angles/direction_counters.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// How likely the directions of the hits in some voxels are, given how many hits each voxel has, by how leaves are
/// turned (ln of the ratio of the axes of Campbell's ellipsoid) and by how apparent density falls with the range
/// (exp(−loss·range)): beams get wider, and have come through more leaves. Relative to one another.
class DirectionLikelihood {
 public:
  static constexpr int kRatios = 14, kLosses = 11;
  static constexpr double kLnRatioStep = 0.2, kFirstLnRatio = -0.6;  ///< spherical leaves: 0
  static constexpr double kLossStepPerM = 0.07;

  /// `full_echo`: intensity of a whole hit; nothing for thin beams, whose hits are counted, and which lose nothing.
  explicit DirectionLikelihood(std::optional<double> full_echo = std::nullopt) : full_echo_(full_echo) {}
  void add(const DirectionCounters& voxel);
  DirectionLikelihood& operator+=(const DirectionLikelihood& other);
  DirectionLikelihood& operator-=(const DirectionLikelihood& other);

  double hits() const;
  bool of_wide_beams() const { return full_echo_.has_value(); }
  /// By the steepness of the rays, as DirectionCounters::kSine.
  std::array<double, DirectionCounters::kSteepness> hits_by_steepness() const;
  /// The most likely ln of the ratio, each with the loss that is most likely for it; nothing where it lies at an end of
  /// what is looked at.
  std::optional<double> ln_ratio() const;

 private:
  double at(int ratio) const;
  int losses() const { return full_echo_ ? kLosses : 1; }

  std::optional<double> full_echo_;
  std::array<double, DirectionCounters::kBins> hits_{};
  /// By loss: Σ hits of a voxel · ln of what its paths meet.
  std::array<Eigen::Array<double, kRatios, 1>, kLosses> hits_ln_met_ = zeros();
  static std::array<Eigen::Array<double, kRatios, 1>, kLosses> zeros();
};

/// ln of the ratio as which leaves turned at random come out, a little flat: the mean of ten sites with thin beams,
/// −0.1 to 0.3. Through wide beams a little steep: the mean of 24 scans, −0.45 to 0.23 (docs/density.md).
inline constexpr double kSphericalLooks = 0.12, kSphericalLooksWide = -0.17;

/// How much ln of the leaves' projection differs, as a standard deviation over the hits by the steepness of their rays,
/// for each unit of ln ratio: 0.11 to 0.17 where a lidar sees steeply up and down, 0.04 to 0.07 where it sees 15° only.
inline constexpr double kUsualLeverage = 0.11;

/// What a scan says of its leaves' angles: the directions of its hits, and of wide beams the normals of full echoes.
struct LeafAngleFit {
  double ln_ratio = 0, error = 0;            ///< by directions, as they look, and the error of sampling
  bool measured = false;                     ///< there are enough hits, and they agree
  double spherical_looks = kSphericalLooks;  ///< ln_ratio that leaves turned at random have in the mean
  LeafAspect aspect;                         ///< of the leaves that the hits met
  double leverage = kUsualLeverage;          ///< as said above
  bool wide_beams = false;
  double lost_share = 0;  ///< of wide beams: EchoModel::lost_share
  bool given = false;     ///< by the options: nothing is sought then
  std::optional<LnRatio> normals;

  /// ln ratio above that of leaves turned at random. The errors include what sites differ by; of directions, what else
  /// apparent density differs by, a few per cent, which is a larger ratio the less the leverage.
  std::optional<LnRatio> by_directions() const;
  std::optional<LnRatio> by_normals() const;
  /// Both weighted by their errors. Nothing where neither tells.
  std::optional<LnRatio> flatter() const;
  /// Leaves are taken for spherical unless they are clearly flatter.
  LeafAngles angles() const;
  /// Whether the angles are known well enough for leaves that lie flat to be told from others.
  bool tells() const;
  /// By how many standard errors directions and normals differ, at least 1: as many times as large is the error of what
  /// they say together, as that of averages is scaled by the Particle Data Group.
  double disagreement() const;
  /// Relative standard error of areas from what is not known of the angles: where leaves are not taken for spherical or
  /// nothing tells, and of what they look flatter than they are taken for.
  double area_error() const;
};

/// From parts of a scan that are independent of each other; errors from how they differ (jackknife).
/// `angles`: those that the options say; of `measured` the fit's own are taken for `aspect`. `normals`: of full echoes.
/// `lost_share`: of wide beams, EchoModel::lost_share.
LeafAngleFit fit_leaf_angles(std::span<const DirectionLikelihood> parts,
                             const LeafAngles& angles = {LeafAngleType::measured, 1},
                             const std::optional<LnRatio>& normals = std::nullopt, double lost_share = 0);

}  // namespace rayfield::density
