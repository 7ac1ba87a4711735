#include "libdensity/rows/passes.h"

#include <algorithm>
#include <cmath>

#include "libdensity/layout/polyline.h"
#include "libdensity/tiles/rounding.h"

namespace rayfield::density {
namespace {

struct Sample {
  Eigen::Vector2d p;
  double time_s;
};

// Vertices at equal distances along the path; a jump starts a new piece. Standstills shrink to nothing.
std::vector<std::vector<Sample>> resample(std::span<const PathPoint> path, const PassOptions& options) {
  std::vector<std::vector<Sample>> pieces;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Eigen::Vector2d p = path[i].position.head<2>();
    if (!p.allFinite()) continue;
    if (pieces.empty() || (p - pieces.back().back().p).norm() > options.max_jump_m + options.spacing_m) {
      pieces.push_back({{p, path[i].time_s}});
      continue;
    }
    // Walk from the last vertex straight to this point in whole steps.
    for (;;) {
      const Sample last = pieces.back().back();
      const Eigen::Vector2d d = p - last.p;
      if (d.norm() < options.spacing_m) break;
      const double share = options.spacing_m / d.norm();
      pieces.back().push_back({last.p + d * share, last.time_s + (path[i].time_s - last.time_s) * share});
    }
  }
  return pieces;
}

std::vector<Sample> smooth(const std::vector<Sample>& in, int reach) {
  std::vector<Sample> out = in;
  const int n = static_cast<int>(in.size());
  for (int i = 0; i < n; ++i) {
    const int r = std::min({reach, i, n - 1 - i});
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int j = i - r; j <= i + r; ++j) sum += in[j].p;
    out[i].p = sum / (2 * r + 1);
  }
  return out;
}

// True where the heading changes over four metres by more than a bend of min_radius_m would.
std::vector<bool> turning(const std::vector<Sample>& s, const PassOptions& options) {
  const int half = std::max(1, round_int(2.0 / options.spacing_m));
  const int n = static_cast<int>(s.size());
  std::vector<bool> turn(s.size(), false);
  const auto at = [&](int i) { return s[static_cast<std::size_t>(std::clamp(i, 0, n - 1))].p; };
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector2d before = at(i) - at(i - half), after = at(i + half) - at(i);
    if (before.norm() < 1e-6 || after.norm() < 1e-6) continue;
    const double angle = std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
    // Headings over two halves of length h differ by h/R.
    if (std::abs(angle) > half * options.spacing_m / options.min_radius_m) turn[i] = true;
  }
  return turn;
}

}  // namespace

double Pass::length_m() const { return polyline_length(line); }

std::vector<Pass> find_passes(std::span<const PathPoint> path, const PassOptions& options) {
  std::vector<Pass> passes;
  const int reach = round_int(1.0 / options.spacing_m);
  for (const auto& piece : resample(path, options)) {
    const std::vector<Sample> s = smooth(piece, reach);
    const std::vector<bool> turn = turning(s, options);
    for (std::size_t i = 0; i < s.size();) {
      if (turn[i]) {
        ++i;
        continue;
      }
      std::size_t j = i;
      Pass pass;
      while (j < s.size() && !turn[j]) pass.line.push_back(s[j++].p);
      pass.start_time_s = s[i].time_s, pass.end_time_s = s[j - 1].time_s;
      if (pass.length_m() >= options.min_length_m) passes.push_back(std::move(pass));
      i = j;
    }
  }
  return passes;
}

}  // namespace rayfield::density
