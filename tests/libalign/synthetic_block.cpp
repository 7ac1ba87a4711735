#include "tests/libalign/synthetic_block.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

namespace rayfield::align {
namespace {

Eigen::Vector2d along_of(const SyntheticBlock& block) {
  return {std::sin(block.azimuth_rad), std::cos(block.azimuth_rad)};
}

}  // namespace

double SyntheticBlock::ground(const Eigen::Vector2d& p) const {
  // Four waves; headings and phases follow from the seed.
  const auto angle = [this](int k) {
    return 2 * std::numbers::pi * std::fmod(0.6180339887 * (seed + 1) * (k + 3), 1.0);
  };
  const Eigen::Vector2d local = p - middle;
  double height = 80 + slope * local.x();
  for (int wave = 0; wave < 4; ++wave) {
    const double heading = angle(2 * wave), phase = angle(2 * wave + 1);
    const double k = 2 * std::numbers::pi / (relief_wavelength_m * (0.7 + 0.2 * wave));
    height += 0.5 * relief_m * std::sin(k * (local.x() * std::cos(heading) + local.y() * std::sin(heading)) + phase);
  }
  return height;
}

Eigen::Vector2d SyntheticBlock::place(int row, double chainage_m, double across_m) const {
  const Eigen::Vector2d along = along_of(*this), left(-along.y(), along.x());
  return middle + along * (chainage_m - 0.5 * length_m) - left * ((row - 0.5 * (rows - 1)) * spacing_m - across_m);
}

std::vector<Upright> SyntheticBlock::uprights() const {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<Upright> all;
  for (int row = 0; row < rows; ++row) {
    const int panels = static_cast<int>(std::lround(length_m / panel_m));
    for (int i = 0; i <= panels; ++i) {
      const bool strainer = i == 0 || i == panels;
      all.push_back({place(row, i * length_m / panels, 0), along_of(*this), strainer ? 0.06 : 0.035, true});
    }
    const int vines = static_cast<int>(std::lround(length_m / vine_m));
    for (int i = 0; i < vines; ++i) {
      const double across = across_jitter_m * normal(random), along = along_jitter_m * normal(random);
      const double radius = 0.027 * (1 + radius_spread * normal(random));
      if (uniform(random) < missing) continue;
      all.push_back({place(row, (i + 0.5) * vine_m + along, across), along_of(*this), radius, false});
    }
  }
  return all;
}

BlockLandmarks drive_along(const SyntheticBlock& block, const SyntheticDrive& drive) {
  std::mt19937 random(drive.seed * 104729U + 3U);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const int last_row = drive.last_row < 0 ? block.rows - 1 : drive.last_row;
  const double to = drive.to_m < 0 ? block.length_m : drive.to_m;
  const Eigen::Vector2d along = along_of(block), left(-along.y(), along.x());
  const auto moved = [&](const Eigen::Vector2d& p) {
    const double phase = 2 * std::numbers::pi / drive.bend_length_m * (p - block.middle).dot(along);
    return drive.error * Eigen::Vector2d(p + drive.bend_m * std::sin(phase) * left);
  };
  BlockLandmarks seen;
  seen.row_spacing_m = block.spacing_m, seen.post_spacing_m = block.panel_m;
  for (const Upright& upright : block.uprights()) {
    const Eigen::Vector2d local = upright.position - block.middle;
    const double chainage = local.dot(along) + 0.5 * block.length_m;
    const double row = -local.dot(left) / block.spacing_m + 0.5 * (block.rows - 1);
    const bool there = row > drive.first_row - 0.3 && row < last_row + 0.3 && chainage > drive.from_m - 0.1 &&
                       chainage < to + 0.1 && uniform(random) < drive.detection;
    const Eigen::Vector2d noise(normal(random), normal(random));
    const double radius = upright.radius_m + 0.003 * normal(random);
    if (there)
      seen.uprights.push_back(
          {moved(upright.position + drive.noise_m * noise), drive.error.turned(along), radius, upright.post});
    if (there && uniform(random) < drive.ghosts)
      seen.uprights.push_back({moved(upright.position + 0.8 * noise.x() * along + 0.1 * noise.y() * left),
                               drive.error.turned(along), 0.02, false});
  }
  for (int row = drive.first_row; row <= last_row; ++row) {
    seen.rows.emplace_back();
    for (double chainage = std::max(0.0, drive.from_m); chainage <= to; chainage += 0.5)
      seen.rows.back().push_back(moved(block.place(row, chainage, 0)));
  }
  // Lanes on both sides of every row that was driven along, and headlands where the drive reached the rows' ends.
  const double beyond = 4;
  const double start = drive.from_m <= 0 ? -beyond : drive.from_m;
  const double end = to >= block.length_m ? block.length_m + beyond : to;
  Eigen::AlignedBox2d box;
  for (int lane = drive.first_row; lane <= last_row + 1; ++lane)
    for (double chainage = start; chainage <= end; chainage += 0.5)
      seen.path.push_back(moved(block.place(lane, chainage, 0.5 * block.spacing_m)));
  for (const Eigen::Vector2d& p : seen.path) box.extend(p);
  const Eigen::Vector2d low = box.min().array().floor() - 3;
  seen.ground = Grid2<float>(low, 1.0, static_cast<int>(box.sizes().x()) + 7, static_cast<int>(box.sizes().y()) + 7,
                             std::numeric_limits<float>::quiet_NaN());
  PlanShift back;
  back.pivot = drive.error.pivot + drive.error.shift.head<2>();
  back.shift = -drive.error.shift, back.yaw_rad = -drive.error.yaw_rad;
  for (const Eigen::Vector2d& p : seen.path)
    for (int dy = -3; dy <= 3; ++dy)
      for (int dx = -3; dx <= 3; ++dx) {
        const Eigen::Vector2d cell = (p - low).array().floor();
        const int ix = static_cast<int>(cell.x()) + dx, iy = static_cast<int>(cell.y()) + dy;
        if (!seen.ground.contains(ix, iy) || std::isfinite(seen.ground.at(ix, iy))) continue;
        const double height = block.ground(back * seen.ground.center(ix, iy));
        seen.ground.at(ix, iy) =
            static_cast<float>(height + drive.error.shift.z() + drive.grass_m + 0.02 * normal(random));
      }
  return seen;
}

PlanShift random_error(const SyntheticBlock& block, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  PlanShift error;
  error.pivot = block.middle;
  error.shift = {5 * uniform(random), 5 * uniform(random), 3 * uniform(random)};
  error.yaw_rad = 0.03 * uniform(random);
  return error;
}

Miss miss_of(const SyntheticBlock& block, const SyntheticDrive& drive, const Alignment& found) {
  Miss miss;
  const auto off = [&](const Eigen::Vector2d& p) {
    const Eigen::Vector2d seen = drive.error * p;
    return ((found * Eigen::Vector3d(seen.x(), seen.y(), 0)).head<2>() - p).norm();
  };
  miss.middle_m = off(block.middle);
  miss.end_m = off(block.place(0, 0, 0));
  return miss;
}

}  // namespace rayfield::align
