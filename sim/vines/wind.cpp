#include "sim/vines/wind.h"

#include <cmath>

#include "rayfield/sim/random.h"
#include "sim/vines/leaf_shapes.h"

namespace rayfield::sim {
namespace {

constexpr double kCycle_s = 120;
constexpr std::uint64_t kSteps = 16;  // a gust every 7.5 s: two passes never meet the same one

}  // namespace

double wind_phase(double time_s) {
  const double phase = std::fmod(time_s, kCycle_s) / kCycle_s;
  return phase < 0 ? phase + 1 : phase;
}

// Between two independent displacements of variance σ² a leaf moves on a straight line, on which the mean variance is
// ∫ ((1 − s)² + s²) σ² ds = 2σ²/3.
std::vector<std::vector<Eigen::Vector3f>> blown_leaves(const Site& site, std::uint64_t seed, const BlockGeometry& block,
                                                       int row, const TriangleMesh& leaves) {
  const double sigma = std::sqrt(1.5) * site.wind.rms_m;
  std::vector<std::vector<Eigen::Vector3f>> steps(kSteps + 1, leaves.vertices);
  const std::size_t vertices = vertices_of(site.canopy.leaf_shape);
  for (std::size_t first = 0; first < leaves.vertices.size(); first += vertices) {
    Eigen::Vector2d center = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < vertices; ++i) center += leaves.vertices[first + i].head<2>().cast<double>();
    center /= static_cast<double>(vertices);
    const double chainage = block.row_position(row, center).chainage;
    const auto shoot = static_cast<std::int64_t>(std::floor(chainage / site.wind.coherence_m));
    for (std::uint64_t step = 0; step <= kSteps; ++step) {
      const std::uint64_t place = mix64((static_cast<std::uint64_t>(row) << 32) + static_cast<std::uint64_t>(shoot));
      CounterRandom random(seed, Stream::wind, place + step % kSteps);
      const Eigen::Vector3d moved = sigma * random.normal3().cwiseProduct(Eigen::Vector3d(1, 1, 1.0 / 3));
      for (std::size_t i = 0; i < vertices; ++i) steps[step][first + i] += moved.cast<float>();
    }
  }
  return steps;
}

}  // namespace rayfield::sim
