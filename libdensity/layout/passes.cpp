#include "rayfield/density/passes.h"

#include <algorithm>
#include <cmath>

#include "libdensity/layout/polyline.h"

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
    for (int j = i - r; j <= i + r; ++j) sum += in[static_cast<std::size_t>(j)].p;
    out[static_cast<std::size_t>(i)].p = sum / (2 * r + 1);
  }
  return out;
}

// True where the heading changes over four metres by more than a bend of min_radius_m would.
std::vector<bool> turning(const std::vector<Sample>& s, const PassOptions& options) {
  const int half = std::max(1, static_cast<int>(std::lround(2.0 / options.spacing_m)));
  const int n = static_cast<int>(s.size());
  std::vector<bool> turn(s.size(), false);
  const auto at = [&](int i) { return s[static_cast<std::size_t>(std::clamp(i, 0, n - 1))].p; };
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector2d before = at(i) - at(i - half), after = at(i + half) - at(i);
    if (before.norm() < 1e-6 || after.norm() < 1e-6) continue;
    const double angle = std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
    // Headings over two halves of length h differ by h/R.
    if (std::abs(angle) > half * options.spacing_m / options.min_radius_m) turn[static_cast<std::size_t>(i)] = true;
  }
  return turn;
}

double piece_score(const std::vector<Eigen::Vector2d>& line, std::size_t i, std::size_t j, StraightRun* run) {
  const Eigen::Vector2d d = line[j] - line[i];
  const double length = d.norm();
  if (length < 1e-9) return 0;
  double low = 0, high = 0;
  for (std::size_t k = i; k <= j; ++k) {
    const Eigen::Vector2d r = line[k] - line[i];
    const double across = (d.x() * r.y() - d.y() * r.x()) / length;
    low = std::min(low, across), high = std::max(high, across);
  }
  const double width = std::max(0.1, high - low);
  if (run) *run = {d / length, length, width, length * length / width};
  return length * length / width;
}

}  // namespace

Result<void> PassOptions::validate() const {
  const bool good = spacing_m >= 0.1 && spacing_m <= 2 && min_length_m >= 3 && min_length_m <= 100 &&
                    min_radius_m >= 5 && min_radius_m <= 50 && max_jump_m >= 0.5 && max_jump_m <= 20;
  if (good) return {};
  return fail(ErrorCode::usage, "cannot find the passes", "options", "value out of range",
              "see rayfield/density/passes.h for the ranges");
}

double Pass::length_m() const { return polyline_length(line); }

std::vector<Pass> find_passes(std::span<const PathPoint> path, const PassOptions& options) {
  std::vector<Pass> passes;
  const int reach = static_cast<int>(std::lround(1.0 / options.spacing_m));
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

StraightRun longest_straight_run(std::span<const Pass> passes) {
  StraightRun best;
  for (const Pass& pass : passes) {
    const auto& line = pass.line;
    const std::size_t n = line.size();
    for (std::size_t start = 0; start + 2 < n; start += std::max<std::size_t>(1, n / 8)) {
      std::size_t i = start, j = start + 2;
      StraightRun run;
      double score = piece_score(line, i, j, &run);
      if (score > best.score_m) best = run;
      while (i > 0 || j + 1 < n) {
        const double forward = j + 1 < n ? piece_score(line, i, j + 1, nullptr) : -1;
        const double backward = i > 0 ? piece_score(line, i - 1, j, nullptr) : -1;
        if (forward >= backward) {
          ++j;
        } else {
          --i;
        }
        score = piece_score(line, i, j, &run);
        if (score > best.score_m) best = run;
      }
    }
  }
  return best;
}

}  // namespace rayfield::density
