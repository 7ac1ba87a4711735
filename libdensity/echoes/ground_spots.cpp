#include "libdensity/echoes/ground_spots.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace rayfield::density {
namespace {

constexpr double kPlaceM = 0.5;         // side of a place, and more
constexpr double kPlacesAcross = 50;    // of larger tiles, so that none takes more memory than one of 25 m
constexpr double kSteepSpotM = 0.03;    // spots less deep than this give the ground's true height
constexpr double kPerDoubling = 5;      // classes of spot depth above
constexpr double kFarthestM = 12;       // farther on a milliradian of the scan's tilt is as much as is looked for
constexpr double kLeastCosine = 0.05;   // of the beam to the ground's normal
constexpr double kAboveGroundM = 0.15;  // what lies farther off the ground is none
constexpr double kUnit = 1e-5;          // m, and of cosines
constexpr std::int64_t kLeastSteep = 8, kLeastAslant = 3;  // echoes of a place

std::int64_t in_units(double value) { return std::llround(value / kUnit); }

}  // namespace

struct GroundSpots::Geometry {
  LidarBeam beam;
  std::shared_ptr<const SensorTrack> track;
  const GroundModel* ground = nullptr;
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();
  double place_m = kPlaceM;              // side of a place
  int side = 0;                          // places
  std::vector<Eigen::Vector3d> normals;  // of the ground at each place; zero where it is not known

  std::optional<std::size_t> place_of(const Eigen::Vector3d& p) const {
    const Eigen::Array2d at = ((p.head<2>() - corner) / place_m).array().floor();
    if ((at < 0).any() || (at >= side).any()) return std::nullopt;
    return static_cast<std::size_t>(at.x()) * static_cast<std::size_t>(side) + static_cast<std::size_t>(at.y());
  }
};

namespace {

Eigen::Vector3d normal_at(const GroundModel& ground, const Eigen::Vector2d& p) {
  const auto east = ground.height(p.x() + kPlaceM, p.y()), west = ground.height(p.x() - kPlaceM, p.y());
  const auto north = ground.height(p.x(), p.y() + kPlaceM), south = ground.height(p.x(), p.y() - kPlaceM);
  if (!east || !west || !north || !south) return Eigen::Vector3d::Zero();
  return Eigen::Vector3d((*west - *east) / (2 * kPlaceM), (*south - *north) / (2 * kPlaceM), 1).normalized();
}

}  // namespace

GroundSpots::GroundSpots(const LidarBeam& beam, std::shared_ptr<const SensorTrack> track, const GroundModel& ground,
                         const tile::TileRef& tile) {
  auto geometry = std::make_shared<Geometry>();
  geometry->beam = beam, geometry->track = std::move(track), geometry->ground = &ground;
  geometry->corner = tile.corner();
  geometry->place_m = std::max(kPlaceM, tile.size_m / kPlacesAcross);
  geometry->side = static_cast<int>(std::ceil(tile.size_m / geometry->place_m));
  for (int x = 0; x < geometry->side; ++x)
    for (int y = 0; y < geometry->side; ++y)
      geometry->normals.push_back(
          normal_at(ground, geometry->corner + geometry->place_m * Eigen::Vector2d(x + 0.5, y + 0.5)));
  sums_.assign(geometry->normals.size() * kDepths, {});
  geometry_ = std::move(geometry);
}

void GroundSpots::add(const tile::SegmentBatch& segments) {
  const Geometry& g = *geometry_;
  std::size_t hint = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if ((segments.flags[i] & tile::kHit) == 0) continue;
    const Eigen::Vector3d end = segments.exit[i];
    const std::optional<std::size_t> place = g.place_of(end);
    if (!place || g.normals[*place].z() <= 0) continue;
    const auto height = g.ground->height(end.x(), end.y());
    if (!height || std::abs(end.z() - *height) > kAboveGroundM) continue;
    const Eigen::Vector3d ray = end - g.track->position(segments.time_s[i], hint), normal = g.normals[*place];
    const double range_m = ray.norm(), cosine = range_m > 0 ? std::abs(ray.dot(normal)) / range_m : 0;
    if (range_m > kFarthestM || cosine < kLeastCosine) continue;
    const double depth_m = g.beam.diameter_at(range_m) * std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine;
    const int depth = depth_m < kSteepSpotM ? 0 : 1 + static_cast<int>(kPerDoubling * std::log2(depth_m / kSteepSpotM));
    if (depth >= kDepths) continue;
    Sum& sum = sums_[*place * kDepths + static_cast<std::size_t>(depth)];
    sum.count += 1, sum.lift += in_units(normal.z() * (end.z() - *height));
    sum.depth += in_units(depth_m), sum.cosine += in_units(cosine);
  }
}

void GroundSpots::merge(const GroundSpots& other) {
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    sums_[i].count += other.sums_[i].count, sums_[i].lift += other.sums_[i].lift;
    sums_[i].depth += other.sums_[i].depth, sums_[i].cosine += other.sums_[i].cosine;
  }
}

std::vector<SpotLift> GroundSpots::lifts() const {
  std::vector<SpotLift> out;
  for (std::size_t place = 0; place < sums_.size(); place += kDepths) {
    const Sum& steep = sums_[place];
    if (steep.count < kLeastSteep) continue;
    const double level = static_cast<double>(steep.lift) / static_cast<double>(steep.count);
    for (std::size_t i = place + 1; i < place + kDepths; ++i) {
      const Sum& aslant = sums_[i];
      if (aslant.count < kLeastAslant) continue;
      const double scale = kUnit / static_cast<double>(aslant.count);
      out.push_back({scale * static_cast<double>(aslant.depth), scale * static_cast<double>(aslant.cosine),
                     scale * static_cast<double>(aslant.lift) - kUnit * level});
    }
  }
  return out;
}

}  // namespace rayfield::density
