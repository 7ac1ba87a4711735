#include "sim/terrain/terrain.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/terrain/smooth_noise.h"
#include "sim/terrain/triangle_mesh.h"

namespace rayfield::sim {
namespace {

constexpr double kCell = 0.15;              // m; fine enough for banks and roughness
constexpr double kDenseMargin = 8.0;        // m around the rows: headlands included
constexpr double kDriveMargin = 8.0;        // m the vehicle goes beyond the rows
constexpr double kRoughnessLattice = 0.25;  // m

// Grid lines symmetric about 0: kCell apart up to `dense`, then ever wider up to `reach`.
std::vector<double> grid_lines(double dense, double reach) {
  std::vector<double> half;
  const int count = static_cast<int>(std::ceil(dense / kCell));
  for (int i = 1; i <= count; ++i) half.push_back(i * kCell);
  double step = kCell;
  while (half.back() < reach) {
    step = std::min(step * 1.3, 2.0);
    half.push_back(half.back() + step);
  }
  std::vector<double> lines;
  for (auto it = half.rbegin(); it != half.rend(); ++it) lines.push_back(-*it);
  lines.push_back(0);
  lines.insert(lines.end(), half.begin(), half.end());
  return lines;
}

// 1 inside the row, falling smoothly to 0 over `fade` m beyond its ends.
double row_end_fade(double chainage, double length, double fade) {
  const double beyond = std::max(-chainage, chainage - length);
  if (beyond <= 0) return 1;
  if (beyond >= fade) return 0;
  const double x = beyond / fade;
  return 1 - x * x * x * (x * (6 * x - 15) + 10);
}

}  // namespace

Terrain::Terrain(const Site& site) : site_(site), block_(site.rows) {
  const Eigen::Vector2d dense = block_.half_extent().array() + kDenseMargin;
  const double reach = site.lidar.max_range_m + kDriveMargin;
  u_ = grid_lines(dense.x(), block_.half_extent().x() + reach);
  v_ = grid_lines(dense.y(), block_.half_extent().y() + reach);
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices.reserve(u_.size() * v_.size());
  mesh->triangles.reserve(2 * u_.size() * v_.size());
  const SiteTerrain& t = site.terrain;
  for (const double v : v_)
    for (const double u : u_) {
      const Eigen::Vector2d p = block_.enu_from_block({u, v});
      double z = smooth_height(p);
      if (t.roughness_m > 0)
        z += t.roughness_m * smooth_noise(site.seed, Stream::terrain_roughness, 0, p.x() / kRoughnessLattice,
                                          p.y() / kRoughnessLattice);
      mesh->add_vertex({p.x(), p.y(), z});
    }
  const auto columns = static_cast<std::uint32_t>(u_.size());
  for (std::uint32_t j = 0; j + 1 < v_.size(); ++j)
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = j * columns + i;
      mesh->add_triangle(a, a + 1, a + columns + 1);
      mesh->add_triangle(a, a + columns + 1, a + columns);
    }
  mesh_ = std::move(mesh);
}

double Terrain::smooth_height(const Eigen::Vector2d& p) const {
  const SiteTerrain& t = site_.terrain;
  const double azimuth = t.slope_azimuth_deg * std::numbers::pi / 180;
  double z = 0.01 * t.slope_percent * (p.x() * std::sin(azimuth) + p.y() * std::cos(azimuth));
  if (t.relief_m > 0) {
    const double lattice = 0.5 * t.relief_wavelength_m;
    z += 0.5 * t.relief_m * smooth_noise(site_.seed, Stream::terrain_relief, 0, p.x() / lattice, p.y() / lattice);
  }
  if (t.bank_height_m > 0) {
    const auto at = block_.row_position(block_.nearest_row(p), p);
    const double x = 2 * at.offset / t.bank_width_m;
    z += t.bank_height_m * std::exp2(-x * x) * row_end_fade(at.chainage, block_.row_length(), 1.5);
  }
  return z;
}

double Terrain::height(const Eigen::Vector2d& p) const {
  const Eigen::Vector2d uv = block_.block_from_enu(p);
  if (uv.x() < u_.front() || uv.x() >= u_.back() || uv.y() < v_.front() || uv.y() >= v_.back()) return smooth_height(p);
  const auto i = static_cast<std::size_t>(std::upper_bound(u_.begin(), u_.end(), uv.x()) - u_.begin() - 1);
  const auto j = static_cast<std::size_t>(std::upper_bound(v_.begin(), v_.end(), uv.y()) - v_.begin() - 1);
  const double s = (uv.x() - u_[i]) / (u_[i + 1] - u_[i]), t = (uv.y() - v_[j]) / (v_[j + 1] - v_[j]);
  const auto z = [&](std::size_t di, std::size_t dj) {
    return static_cast<double>(mesh_->vertices[(j + dj) * u_.size() + i + di].z());
  };
  // The diagonal runs from corner (0, 0) to (1, 1).
  if (s >= t) return z(0, 0) + s * (z(1, 0) - z(0, 0)) + t * (z(1, 1) - z(1, 0));
  return z(0, 0) + t * (z(0, 1) - z(0, 0)) + s * (z(1, 1) - z(0, 1));
}

}  // namespace rayfield::sim
