#include "sim/scan/wide_beam.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "rayfield/sim/random.h"
#include "sim/vines/leaf_shapes.h"
#include "sim/world/ray_scene.h"
#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {
namespace {

constexpr double kPi = std::numbers::pi;

// k(t): a straight edge k disc radii outside the centre leaves the share t of a uniform disc covered,
// t = (acos k − k √(1 − k²)) / π. Solved by bisection.
double edge_offset(double t) {
  double low = -1, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double k = 0.5 * (low + high);
    ((std::acos(k) - k * std::sqrt(1 - k * k)) / kPi > t ? low : high) = k;
  }
  return low;
}

// Share of a uniform disc of diameter `disc` that a strip of width `strip` through its centre covers.
double strip_share(double strip, double disc) {
  const double x = strip / disc;
  return x >= 1 ? 1 : 2 / kPi * (std::asin(x) + x * std::sqrt(1 - x * x));
}

SiteLidar lms511(double detection_share) {
  SiteLidar lidar;
  lidar.beam_diameter_m = 0.0136;
  lidar.divergence_mrad = 11.9;
  lidar.detection_share = detection_share;
  return lidar;
}

// Plane pieces that face a lidar at the origin which looks along x.
class Plates {
 public:
  Plates() : scene_(take(RayScene::create())) {}
  // A plate `range` in front, from `left` to `right` (y, to the left) and 10 m high.
  Plates& add(double range, double right, double left, Material material) {
    TriangleMesh mesh;
    mesh.add_quad({range, right, -5}, {range, left, -5}, {range, left, 5}, {range, right, 5});
    EXPECT_TRUE(scene_.add(mesh, material));
    return *this;
  }
  const RayScene& ready() {
    EXPECT_TRUE(scene_.commit());
    return scene_;
  }

 private:
  RayScene scene_;
};

// The return of a beam that leaves `y` to the left of the origin along x; turn and dither are drawn.
std::optional<Echo> look(const WideBeam& beam, const RayScene& scene, double y, CounterRandom& random) {
  const Shot shot{{0, y, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};
  WideBeam::Bundle bundle;
  beam.aim(shot, 2 * kPi * random.uniform(), bundle);
  scene.cast(bundle.rays, 100, 0, bundle.hits);
  return beam.receive(
      bundle.hits, [] { return 1.0; }, random.uniform() - 0.5, [](const Echo&) { return false; });
}

double return_rate(const WideBeam& beam, const RayScene& scene, double y, int shots) {
  CounterRandom random(7, Stream::experiment);
  int count = 0;
  for (int i = 0; i < shots; ++i) count += look(beam, scene, y, random) ? 1 : 0;
  return static_cast<double>(count) / shots;
}

// ∫ P(return) dy over beams that leave side by side.
double apparent_width(const WideBeam& beam, const RayScene& scene, double reach, std::uint64_t seed) {
  constexpr int kShots = 20000;
  int count = 0;
  for (int i = 0; i < kShots; ++i) {
    CounterRandom random(seed, Stream::experiment, static_cast<std::uint64_t>(i));
    const double y = reach * (2 * (i + random.uniform()) / kShots - 1);
    count += look(beam, scene, y, random) ? 1 : 0;
  }
  return 2 * reach * count / kShots;
}

// A post of width w appears w + 2·k(t)·ρ wide, ρ the radius of the disc at its range. A disc of 37 sub-rays covers a
// share with a scatter of about 1/60, which is ρ/50 at an edge: its mean is what is tested.
TEST(WideBeam, APostAppearsWiderByTwiceTheEdgeOffset) {
  constexpr double kWidth = 0.25;
  for (const double t : {0.10, 0.25, 0.50, 0.70})
    for (const double range : {1.5, 4.0, 9.0}) {
      const WideBeam beam(lms511(t), SiteReflectance{.leaf = 0.5, .post = 0.5});
      Plates plates;
      plates.add(range, -kWidth / 2, kWidth / 2, Material::post);
      const double radius = 0.5 * (0.0136 + 0.0119 * range);
      const double expected = kWidth + 2 * edge_offset(t) * radius;
      EXPECT_NEAR(apparent_width(beam, plates.ready(), 0.5 * kWidth + 2 * radius, 3), expected, 0.03 * radius)
          << t << " at " << range << " m";
    }
}

TEST(WideBeam, ABrighterPostNeedsLessOfTheBeam) {
  const WideBeam beam(lms511(0.4), SiteReflectance{.leaf = 0.35, .post = 0.7});
  Plates plates;
  plates.add(4, -0.15, 0.15, Material::post);
  const double radius = 0.5 * (0.0136 + 0.0119 * 4);
  EXPECT_NEAR(apparent_width(beam, plates.ready(), 0.25, 5), 0.3 + 2 * edge_offset(0.2) * radius, 0.03 * radius);
}

TEST(WideBeam, TheThresholdMayChangeWithRange) {
  SiteLidar lidar = lms511(0.2);
  lidar.detection_range_exponent = 1;
  const double range = 10, radius = 0.5 * (0.0136 + 0.0119 * range);
  Plates plates;
  plates.add(range, -0.2, 0.2, Material::leaf);
  // Twice the share at twice the reference range of 5 m.
  EXPECT_NEAR(apparent_width(WideBeam(lidar, {}), plates.ready(), 0.35, 9), 0.4 + 2 * edge_offset(0.4) * radius,
              0.03 * radius);
}

// A wire returns as long as it covers the detectable share of a disc about it.
TEST(WideBeam, AWireVanishesWhereItCoversLessThanTheThreshold) {
  constexpr double kWire = 0.003;
  for (const double t : {0.1, 0.2}) {
    SiteLidar lidar = lms511(t);
    lidar.sub_rays = 256;
    double low = kWire, high = 1;
    for (int i = 0; i < 60; ++i) {
      const double disc = 0.5 * (low + high);
      (strip_share(kWire, disc) > t ? low : high) = disc;
    }
    const double last_range = (low - 0.0136) / 0.0119;
    ASSERT_GT(last_range, 0.3);  // the beam is not too wide for this wire at any range
    const WideBeam beam(lidar, SiteReflectance{.leaf = 0.5, .wire = 0.5});
    Plates near, far;
    near.add(0.7 * last_range, -kWire / 2, kWire / 2, Material::wire);
    far.add(1.3 * last_range, -kWire / 2, kWire / 2, Material::wire);
    EXPECT_GT(return_rate(beam, near.ready(), 0, 400), 0.97) << t;
    EXPECT_LT(return_rate(beam, far.ready(), 0, 400), 0.03) << t;
  }
}

// The front plate covers the share s of the disc, what passes meets a plate behind: within the range resolution both
// make one return at r + (1 − s)·gap; further apart each makes its own.
TEST(WideBeam, PlatesWithinTheRangeResolutionMixAndOthersDoNot) {
  constexpr double kRange = 5, kResolution = 0.15;
  SiteLidar lidar = lms511(0.25);
  lidar.range_resolution_m = kResolution;
  const double radius = 0.5 * (0.0136 + 0.0119 * kRange);
  for (const double share : {0.35, 0.5, 0.65}) {
    const double y = edge_offset(share) * radius;  // the front plate lies at y < 0
    const auto mean_range = [&](double gap, ReturnMode mode) {
      Plates plates;
      plates.add(kRange, -2, 0, Material::leaf).add(kRange + gap, -2, 2, Material::leaf);
      const RayScene& scene = plates.ready();
      lidar.returns = mode;
      const WideBeam beam(lidar, {});
      CounterRandom random(11, Stream::experiment);
      double sum = 0;
      for (int i = 0; i < 400; ++i) sum += look(beam, scene, y, random).value().range_m;
      return sum / 400;
    };
    const double closer = 0.8 * kResolution, farther = 1.2 * kResolution;
    EXPECT_NEAR(mean_range(closer, ReturnMode::first), kRange + (1 - share) * closer, 0.02 * closer) << share;
    EXPECT_NEAR(mean_range(farther, ReturnMode::first), kRange, 1e-3) << share;
    EXPECT_NEAR(mean_range(farther, ReturnMode::last), kRange + farther, 1e-3) << share;
    // With 37 sub-rays shares within a twentieth of a half may go either way.
    if (share != 0.5) {
      EXPECT_NEAR(mean_range(farther, ReturnMode::strongest), kRange + (share < 0.5 ? farther : 0), 1e-3) << share;
    }
  }
}

TEST(WideBeam, EnergyAndIntensityFollowTheCoveredShareAndTheReflectance) {
  const SiteReflectance reflectance{.leaf = 0.4, .wood = 0.6};
  const double range = 3, radius = 0.5 * (0.0136 + 0.0119 * range);
  for (const double share : {0.4, 0.7, 1.0}) {
    Plates plates;
    plates.add(range, -2, 0, Material::wood);
    const RayScene& scene = plates.ready();
    const WideBeam beam(lms511(0.2), reflectance);
    CounterRandom random(13, Stream::experiment);
    double energy = 0, strength = 0;
    for (int i = 0; i < 400; ++i) {
      const Echo echo = look(beam, scene, share == 1.0 ? -0.5 : edge_offset(share) * radius, random).value();
      energy += echo.energy / 400, strength += echo.strength / 400;
    }
    EXPECT_NEAR(energy, share * 0.6 / 0.4, 0.02) << share;
    EXPECT_NEAR(strength, 255 * share * 0.6, 0.02 * 255) << share;
  }
}

// By returned energy the unit is the mean leaf, whose cosine is 2/3: one that faces the lidar sends back 1 / (1 − a/3),
// one at the angle i 1 − a·(1 − cos i) of that. By covered share the angle is nothing to detection.
TEST(WideBeam, SurfacesMetAslantMayFallBelowTheThresholdWhereEnergyDecides) {
  const SiteReflectance reflectance{.angle_dependence = 0.7};
  constexpr auto kEnergy = Detection::returned_energy, kShare = Detection::covered_share;
  const double facing = 1 / (1 - 0.7 / 3);
  EXPECT_NEAR(sub_echo(reflectance, kEnergy, {5, Material::leaf, 1}, 1).energy, facing, 1e-12);
  EXPECT_NEAR(sub_echo(reflectance, kEnergy, {5, Material::leaf, 2.0 / 3}, 1).energy, 1, 1e-12);
  EXPECT_NEAR(sub_echo(reflectance, kEnergy, {5, Material::leaf, 0}, 0.5).energy, 0.5 * 0.3 * facing, 1e-12);
  EXPECT_NEAR(sub_echo(reflectance, kShare, {5, Material::leaf, 0}, 0.5).energy, 0.5, 1e-12);
  SiteLidar lidar = lms511(0.5);
  const std::vector<SceneHit> aslant(37, {5, Material::leaf, 0.01}), straight(37, {5, Material::leaf, 1});
  const auto returns = [&](const std::vector<SceneHit>& hits) {
    return WideBeam(lidar, reflectance)
        .receive(
            hits, [] { return 1.0; }, 0, [](const Echo&) { return false; })
        .has_value();
  };
  EXPECT_TRUE(returns(straight));
  EXPECT_TRUE(returns(aslant));
  lidar.detection = kEnergy;
  EXPECT_TRUE(returns(straight));
  EXPECT_FALSE(returns(aslant));
}

// What comes back scatters before it is held against the threshold, so that a weak beam may be heard and a strong one
// not, and each surface scatters by itself.
TEST(WideBeam, ScatterOfWhatComesBackDecidesOnTheEchoToo) {
  const SiteReflectance reflectance{.leaf = 0.5};
  SiteLidar lidar = lms511(0.5);
  lidar.echo_scatter = 0.2;
  const WideBeam beam(lidar, reflectance);
  const auto echo_of = [&](const std::vector<SceneHit>& hits, std::vector<double> gains) {
    auto next = gains.begin();
    return beam.receive(
        hits, [&] { return *next++; }, 0, [](const Echo&) { return false; });
  };
  const auto leaf = [](std::size_t sub_rays, float range_m) {
    return std::vector<SceneHit>(sub_rays, {range_m, Material::leaf, 1});
  };
  EXPECT_TRUE(echo_of(leaf(20, 5), {1}).has_value());
  EXPECT_FALSE(echo_of(leaf(20, 5), {0.8}).has_value());
  EXPECT_FALSE(echo_of(leaf(17, 5), {1}).has_value());
  EXPECT_TRUE(echo_of(leaf(17, 5), {1.2}).has_value());
  EXPECT_NEAR(echo_of(leaf(37, 5), {1.3})->strength, 1.3 * 255 * 0.5, 1e-9);
  EXPECT_NEAR(echo_of(leaf(37, 5), {1.3})->range_m, 5, 1e-9);
  std::vector<SceneHit> two = leaf(10, 5.1F);
  for (const SceneHit& hit : leaf(27, 5)) two.push_back(hit);
  const std::optional<Echo> mixed = echo_of(two, {1.1, 0.7});  // the nearer one's first
  EXPECT_NEAR(mixed->strength, (1.1 * 27 + 0.7 * 10) / 37 * 255 * 0.5, 1e-6);
}

// Steiner: a disc that a straight edge may leave by k(t)·ρ enlarges a convex shadow of area A and perimeter P to
// A + P·δ + π·δ², δ = k·ρ. Over random orientations of a flat leaf of area a and perimeter p, ⟨A⟩ = a/2 and
// ⟨P⟩ = πp/4, hence g = 1 + (π/2)(p/a)δ + 2πδ²/a. Beams and lines at the same places are
// compared, so that only what differs between them scatters. Corners leave out terms of the order of ρ².
TEST(WideBeam, SmallDiscsEnlargeALeafAsSteinerSays) {
  constexpr double kLeaf_m2 = 0.01, kReach = 0.12;
  TriangleMesh mesh;
  add_leaf(mesh, LeafShape::rhombus, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
           kLeaf_m2);
  RayScene scene = take(RayScene::create());
  ASSERT_TRUE(scene.add(mesh, Material::leaf));
  ASSERT_TRUE(scene.commit());
  const double half_a = 1.05 * 0.5 * std::sqrt(2 * kLeaf_m2), half_b = 0.5 * std::sqrt(2 * kLeaf_m2) / 1.05;
  const double perimeter = 4 * std::hypot(half_a, half_b);
  for (const double t : {0.1, 0.25, 0.6}) {
    SiteLidar lidar;
    lidar.beam_diameter_m = 0.006;
    lidar.detection_share = t;
    const WideBeam beam(lidar, {});
    constexpr int kShots = 60000;
    double lines = 0, discs = 0, differ = 0;
    for (std::uint64_t i = 0; i < kShots; ++i) {
      CounterRandom random(17, Stream::experiment, i);
      Shot shot;
      shot.direction = random.normal3().normalized();
      shot.across = shot.direction.unitOrthogonal();
      shot.along_z = shot.direction.cross(shot.across);
      shot.origin = random.uniform(-kReach, kReach) * shot.across + random.uniform(-kReach, kReach) * shot.along_z -
                    shot.direction;
      WideBeam::Bundle bundle;
      beam.aim(shot, 2 * kPi * random.uniform(), bundle);
      scene.cast(bundle.rays, 2, 0, bundle.hits);
      const auto return_of_disc = beam.receive(
          bundle.hits, [] { return 1.0; }, random.uniform() - 0.5, [](const Echo&) { return false; });
      const bool disc = return_of_disc.has_value();
      const bool line = scene.cast(shot.origin, shot.direction, 2).has_value();
      discs += disc ? 1 : 0, lines += line ? 1 : 0, differ += disc != line ? 1 : 0;
    }
    const double radius = 0.003, delta = edge_offset(t) * radius;
    const double g = 1 + kPi / 2 * perimeter / kLeaf_m2 * delta + 2 * kPi * delta * delta / kLeaf_m2;
    const double standard_error = std::sqrt(differ) / lines, corners = 2 * kPi * radius * radius / kLeaf_m2;
    ASSERT_LT(4 * standard_error + corners, 0.25 * kPi / 2 * perimeter / kLeaf_m2 * radius);
    EXPECT_NEAR(discs / lines, g, 4 * standard_error + corners) << t;
    // Lines meet the mean shadow, a/2.
    EXPECT_NEAR(lines / kShots * 4 * kReach * kReach, kLeaf_m2 / 2,
                5 * std::sqrt(lines) / kShots * 4 * kReach * kReach);
  }
}

TEST(WideBeam, AnEllipticalBeamIsWiderAcrossItsLongAxis) {
  SiteLidar lidar;
  lidar.beam_diameter_m = 0.01;
  lidar.divergence_mrad = 6;
  lidar.divergence_z_mrad = 1;
  lidar.sub_rays = 256;
  const WideBeam beam(lidar, {});
  const Shot shot{Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                  Eigen::Vector3d::UnitZ()};
  WideBeam::Bundle bundle;
  Eigen::Vector3d square = Eigen::Vector3d::Zero();
  beam.aim(shot, 0.3, bundle);
  for (const SceneRay& ray : bundle.rays) square += (ray.origin + 10 * ray.direction).cwiseAbs2();
  // A uniform disc of radius R has a variance of R²/4 along each axis; R = 5 mm + half the angle times 10 m.
  EXPECT_NEAR(std::sqrt(square.y() / 256), 0.035 / 2, 0.02 * 0.035);
  EXPECT_NEAR(std::sqrt(square.z() / 256), 0.010 / 2, 0.02 * 0.010);
}

TEST(WideBeam, AGaussianBeamHoldsItsEnergyWithinTheRadiusOfE2) {
  SiteLidar lidar;
  lidar.beam_diameter_m = 0.02;
  lidar.energy_profile = EnergyProfile::gaussian;
  lidar.sub_rays = 256;
  const WideBeam beam(lidar, {});
  const Shot shot{Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                  Eigen::Vector3d::UnitZ()};
  WideBeam::Bundle bundle;
  int half = 0, full = 0;
  beam.aim(shot, 0, bundle);
  for (const SceneRay& ray : bundle.rays) {
    half += ray.origin.norm() < 0.005 ? 1 : 0;
    full += ray.origin.norm() < 0.010 ? 1 : 0;
  }
  // 1 − exp(−2x²) within x radii; the tail beyond 1.5 is cut.
  const double kept = 1 - std::exp(-4.5);
  EXPECT_NEAR(half / 256.0, (1 - std::exp(-0.5)) / kept, 1.0 / 256);
  EXPECT_NEAR(full / 256.0, (1 - std::exp(-2.0)) / kept, 1.0 / 256);
}

}  // namespace
}  // namespace rayfield::sim
