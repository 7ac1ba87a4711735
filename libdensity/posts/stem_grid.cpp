#include "libdensity/posts/stem_grid.h"
#include "libdensity/tiles/rounding.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace rayfield::density {
namespace {

constexpr double kSkin = 0.03;       // m; hits lie on the surface to within range noise and registration
constexpr double kCollar = 0.12;     // m; outer edge of the surroundings, measured from the surface
constexpr double kLargest = 0.12;    // m; radius of the thickest post
constexpr double kThinnest = 0.008;  // m
constexpr double kUpright = 3;       // hits·m²; a prior of 2° on the lean, against 5 cm of scatter per hit

struct Seed {
  int a = 0, c = 0;
  int layers = 0, hits = 0;
};

// Hits in a layer on a disc and on the collar around it, as densities per m².
struct Contrast {
  double on = 0, around = 0;  // hits
  double on_area = 1, around_area = 1;
  /// Hits beyond what the surroundings have on as large an area.
  double excess() const { return on - around * on_area / around_area; }
  double ratio() const { return (on / on_area) / std::max(around / around_area, 0.5 / around_area); }
  void add(const Contrast& other) { on += other.on, around += other.around; }
};

template <class F>
void for_cells_near(const StemGrid& g, const Eigen::Vector2d& centre, double radius, F&& visit) {
  const int a0 = std::max(0, floor_int((centre.x() - radius) / g.cell_m) - g.first_along);
  const int a1 = std::min(g.n_along - 1, floor_int((centre.x() + radius) / g.cell_m) - g.first_along);
  const int c0 = std::max(0, floor_int((centre.y() + g.half_width_m - radius) / g.cell_m));
  const int c1 = std::min(g.n_across - 1, floor_int((centre.y() + g.half_width_m + radius) / g.cell_m));
  for (int a = a0; a <= a1; ++a)
    for (int c = c0; c <= c1; ++c) {
      const Eigen::Vector2d d = Eigen::Vector2d(g.along_m(a), g.across_m(c)) - centre;
      if (d.norm() <= radius) visit(a, c, d);
    }
}

Contrast contrast_at(const StemGrid& g, const Eigen::Vector2d& centre, double radius, int layer) {
  Contrast out;
  const double inner = radius + kSkin, outer = radius + kCollar;
  out.on_area = M_PI * inner * inner, out.around_area = M_PI * (outer * outer - inner * inner);
  for_cells_near(g, centre, outer, [&](int a, int c, const Eigen::Vector2d& d) {
    (d.norm() <= inner ? out.on : out.around) += g.column(a, c)[layer];
  });
  return out;
}

struct Zone {
  int first = 0, end = 0;  // layers
};

Zone low_zone(const StemGrid& g, const PostOptions& options) {
  return {round_int(options.low_min_m / g.layer_m), std::min(g.n_layers, round_int(options.low_max_m / g.layer_m))};
}

// Places where hits stand above each other through (nearly) the whole low zone, best first within 0.15 m.
std::vector<Seed> find_seeds(const StemGrid& g, const Zone& zone) {
  const int reach = round_int(0.06 / g.cell_m);
  const int n_zone = zone.end - zone.first;
  std::vector<Seed> all;
  for (int a = 0; a < g.n_along; ++a)
    for (int c = 0; c < g.n_across; ++c) {
      std::vector<int> per_layer(static_cast<std::size_t>(n_zone), 0);
      for (int da = -reach; da <= reach; ++da)
        for (int dc = -reach; dc <= reach; ++dc) {
          if (da * da + dc * dc > reach * reach || a + da < 0 || a + da >= g.n_along || c + dc < 0 ||
              c + dc >= g.n_across)
            continue;
          const auto column = g.column(a + da, c + dc);
          for (int s = 0; s < n_zone; ++s) per_layer[s] += column[static_cast<std::size_t>(zone.first + s)];
        }
      Seed seed{a, c, 0, 0};
      for (int n : per_layer) seed.layers += n >= 1, seed.hits += n;
      if (seed.layers >= n_zone - 1 && seed.hits >= 2 * n_zone) all.push_back(seed);
    }
  std::sort(all.begin(), all.end(), [](const Seed& p, const Seed& q) {
    return std::make_tuple(-p.hits, p.a, p.c) < std::make_tuple(-q.hits, q.a, q.c);
  });
  const int apart = round_int(0.15 / g.cell_m);
  std::vector<Seed> kept;
  for (const Seed& seed : all) {
    const bool free = std::none_of(kept.begin(), kept.end(), [&](const Seed& k) {
      return (k.a - seed.a) * (k.a - seed.a) + (k.c - seed.c) * (k.c - seed.c) < apart * apart;
    });
    if (free) kept.push_back(seed);
  }
  return kept;
}

struct Circle {
  Eigen::Vector2d centre;
  double radius = 0.03;
};

// Where the hits of each low layer lie beside all of them, by their centres of mass. Trunks bend, and a circle through
// the hits of all heights at once would come out wider by as much. Both lanes see every layer from the same sides, so
// that what the centres of mass miss of the axis is the same for all.
std::vector<Eigen::Vector2d> bend_of(const StemGrid& g, const Zone& zone, const Eigen::Vector2d& centre) {
  constexpr double kNear = 0.08, kMostBend = 0.03;  // m
  constexpr double kEnough = 6;                     // hits
  std::vector<Eigen::Vector2d> sums(static_cast<std::size_t>(zone.end - zone.first), Eigen::Vector2d::Zero());
  std::vector<double> hits(sums.size(), 0.0);
  for_cells_near(g, centre, kNear, [&](int a, int c, const Eigen::Vector2d& d) {
    const auto column = g.column(a, c);
    for (std::size_t s = 0; s < sums.size(); ++s) {
      const double n = column[static_cast<std::size_t>(zone.first) + s];
      sums[s] += n * d, hits[s] += n;
    }
  });
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double total = 0;
  for (std::size_t s = 0; s < sums.size(); ++s)
    if (hits[s] >= kEnough) mean += sums[s], total += hits[s];
  std::vector<Eigen::Vector2d> bend(sums.size(), Eigen::Vector2d::Zero());
  for (std::size_t s = 0; s < sums.size(); ++s) {
    if (hits[s] < kEnough) continue;
    bend[s] = sums[s] / hits[s] - mean / total;
    if (bend[s].norm() > kMostBend) bend[s] *= kMostBend / bend[s].norm();
  }
  return bend;
}

// Gauss-Newton on Σ w(|p−b−c|−R)², cells of the low zone within reach, b the bend at their height; a weak pull keeps R
// near 3 cm where only an arc is seen. Cells beyond 5 cm from the surface are left out as the fit proceeds.
Circle fit_circle(const StemGrid& g, const Zone& zone, const Eigen::Vector2d& start) {
  constexpr int kCentring = 3;  // iterations that only move the circle to the hits' centre of mass
  Circle circle{start, 0.03};
  double reach = 0.12, scatter = 0;
  std::vector<Eigen::Vector2d> bend(static_cast<std::size_t>(zone.end - zone.first), Eigen::Vector2d::Zero());
  for (int iteration = 0; iteration < 20; ++iteration) {
    if (iteration == kCentring) bend = bend_of(g, zone, circle.centre);
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    double total = 0, squares = 0;
    for_cells_near(g, circle.centre, reach, [&](int a, int c, const Eigen::Vector2d& from_centre) {
      const auto column = g.column(a, c);
      for (std::size_t s = 0; s < bend.size(); ++s) {
        const double w = column[static_cast<std::size_t>(zone.first) + s];
        if (w <= 0) continue;
        const Eigen::Vector2d d = from_centre - bend[s];
        total += w, mean += w * d;
        const double r = std::max(d.norm(), 1e-4);
        const Eigen::Vector3d row(-d.x() / r, -d.y() / r, -1);
        const double residual = r - circle.radius;
        squares += w * residual * residual;
        normal += w * row * row.transpose();
        right -= w * residual * row;
      }
    });
    if (total < 4) return circle;
    scatter = squares / total;
    if (iteration < kCentring) {
      circle.centre += mean / total;
      continue;
    }
    normal(2, 2) += 0.02 * total;
    right(2) += 0.02 * total * (0.03 - circle.radius);
    normal(0, 0) += 0.01 * total, normal(1, 1) += 0.01 * total;
    Eigen::Vector3d step = normal.ldlt().solve(right);
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > 0.02) step *= 0.02 / longest;
    circle.centre += step.head<2>();
    circle.radius = std::clamp(circle.radius + step(2), kThinnest, kLargest);
    reach = circle.radius + 0.05;
  }
  // Scatter along the tangent moves points outwards: E|p−c| = R + σ²/2R.
  circle.radius = std::max(kThinnest, circle.radius - 0.5 * scatter / circle.radius);
  return circle;
}

// Fits the axis to the centres of mass of the low layers, then follows it upwards while hits stand out on it.
void follow_up(const StemGrid& g, const Zone& zone, const Circle& circle, double low_hits, const PostOptions& options,
               GridStem& stem) {
  const double middle = 0.5 * (zone.first + zone.end) * g.layer_m;
  double sw = 1e-9, sh = 0, shh = 0;
  Eigen::Vector2d sp = Eigen::Vector2d::Zero(), shp = Eigen::Vector2d::Zero();
  Eigen::Vector2d lean = Eigen::Vector2d::Zero(), centre = circle.centre;
  const auto take = [&](int layer) {
    const double h = (layer + 0.5) * g.layer_m - middle;
    const Eigen::Vector2d at = centre + lean * h;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double w = 0;
    for_cells_near(g, at, circle.radius + kSkin, [&](int a, int c, const Eigen::Vector2d& d) {
      const double n = g.column(a, c)[layer];
      sum += n * d, w += n;
    });
    if (w < 2) return;
    const Eigen::Vector2d p = at + sum / w;
    w = std::min(w, 20.0);  // more hits do not make a layer's centre of mass less dependent on what is in front of it
    sw += w, sh += w * h, shh += w * h * h, sp += w * p, shp += w * h * p;
    const double spread = shh - sh * sh / sw + kUpright;
    lean = (shp - sh / sw * sp) / spread;
    if (lean.norm() > 0.2) lean *= 0.2 / lean.norm();
  };
  for (int layer = zone.first; layer < zone.end; ++layer) take(layer);
  // One leaf on the axis looks like a layer of trunk, two above each other are rare: after a gap it takes two. Of the
  // last layer the stem fills as much as it has hits of a full one.
  int missing = 0, run = 0, top = zone.end;
  double last = low_hits;
  const double radius = circle.radius;
  for (int layer = zone.end; layer < g.n_layers && missing < 3; ++layer) {
    const double h = (layer + 0.5) * g.layer_m - middle;
    const Contrast here = contrast_at(g, centre + lean * h, radius, layer);
    const bool on = here.excess() >= std::max(2.0, 0.4 * low_hits) && here.ratio() >= 1.5;
    missing = on ? 0 : missing + 1;
    run = on ? run + 1 : 0;
    if (on && (layer == top || run >= 2)) top = layer + 1, last = here.excess();
    if (here.on >= 2 && here.ratio() >= options.min_contrast) take(layer);
  }
  stem.top_m = (top - 1 + std::min(1.0, last / low_hits)) * g.layer_m;
  stem.lean = lean;
  stem.foot = centre - lean * middle;
}

// The two neighbouring layers above the trunks' height in which the stem stands out best; share 0 if it never does.
struct UpperPart {
  int layer = 0;
  double share = 0;  ///< hits relative to the low zone
};

UpperPart find_upper(const StemGrid& g, const PostOptions& options, double low_hits, const GridStem& stem) {
  UpperPart best;
  for (int layer = round_int(options.min_post_height_m / g.layer_m); layer + 1 < g.n_layers; ++layer) {
    Contrast pair;
    double least = std::numeric_limits<double>::infinity();
    for (int s = layer; s < layer + 2; ++s) {
      const Contrast here = contrast_at(g, stem.foot + stem.lean * ((s + 0.5) * g.layer_m), stem.radius_m, s);
      pair.on_area = here.on_area, pair.around_area = here.around_area;
      pair.add(here);
      least = std::min(least, here.on);
    }
    if (pair.on < 6 || pair.ratio() < options.min_contrast) continue;
    // A post shows in both layers, a tuft of leaves or a cane in one; the post's top may end within the upper one.
    const double share = std::min(pair.on / 2, 2 * least) / low_hits;
    if (share > best.share) best = {layer, share};
  }
  return best;
}

// Puts the axis through the circle's centre in the low zone and that of a circle of the same radius in the upper part
// (Gauss-Newton on Σ w(|p−c|−R)², Tukey weights: leaves beside the post do not pull).
void straighten(const StemGrid& g, const Zone& zone, const Eigen::Vector2d& low_centre, const UpperPart& upper,
                GridStem& stem) {
  constexpr double kTukey = 0.04;  // m
  const double low_h = 0.5 * (zone.first + zone.end) * g.layer_m, high_h = (upper.layer + 1) * g.layer_m;
  Eigen::Vector2d centre = stem.foot + stem.lean * high_h;
  for (int iteration = 0; iteration < 10; ++iteration) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Identity() * 1e-3;
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for_cells_near(g, centre, stem.radius_m + kTukey, [&](int a, int c, const Eigen::Vector2d& d) {
      const double residual = d.norm() - stem.radius_m, share = residual / kTukey;
      const auto column = g.column(a, c);
      const double n = column[upper.layer] + column[static_cast<std::size_t>(upper.layer + 1)];
      if (n <= 0 || std::abs(share) >= 1 || d.norm() < 1e-4) return;
      const double w = n * (1 - share * share) * (1 - share * share);
      const Eigen::Vector2d row = -d / d.norm();
      normal += w * row * row.transpose();
      right -= w * residual * row;
    });
    Eigen::Vector2d step = normal.ldlt().solve(right);
    if (step.norm() > 0.01) step *= 0.01 / step.norm();
    centre += step;
  }
  stem.lean = (centre - low_centre) / (high_h - low_h);
  if (stem.lean.norm() > 0.2) stem.lean *= 0.2 / stem.lean.norm();
  stem.foot = low_centre - stem.lean * low_h;
}

// The height at which hits on the axis end: the part of the last layer follows from its hits relative to a full one.
double top_of(const StemGrid& g, double low_hits, const UpperPart& upper, const GridStem& stem) {
  int top = upper.layer + 1;
  double full = 0, last = 0;
  for (int layer = upper.layer; layer < g.n_layers; ++layer) {
    const Contrast here = contrast_at(g, stem.foot + stem.lean * ((layer + 0.5) * g.layer_m), stem.radius_m, layer);
    if (here.on < std::max(2.0, 0.1 * low_hits) || here.ratio() < 1.5) break;
    full = std::max(full, last), last = here.on, top = layer + 1;
  }
  return (top - (full > 0 ? std::clamp(1 - last / full, 0.0, 1.0) : 0.0)) * g.layer_m;
}

// Log-likelihood ratio of a solid post, whose core takes few hits, against leaves, which fall on the disc evenly.
double solidity_of(const StemGrid& g, const GridStem& stem) {
  constexpr double kCanopy = 1.0, kSolidRadius = 0.035;  // m; thinner stems have no core that noise would not fill
  if (stem.radius_m < kSolidRadius) return 0;
  double core = 0, on = 0;
  for (int layer = round_int(kCanopy / g.layer_m); layer < g.n_layers; ++layer)
    for_cells_near(g, stem.foot + stem.lean * ((layer + 0.5) * g.layer_m), stem.radius_m + kSkin,
                   [&](int a, int c, const Eigen::Vector2d& d) {
                     const double n = g.column(a, c)[layer];
                     on += n;
                     if (d.norm() < stem.radius_m - 0.02) core += n;
                   });
  const double leaf = std::pow((stem.radius_m - 0.02) / (stem.radius_m + kSkin), 2), post = 0.3 * leaf;
  return core * std::log(post / leaf) + (on - core) * std::log((1 - post) / (1 - leaf));
}

}  // namespace

std::vector<GridStem> find_stems(const StemGrid& grid, const PostOptions& options) {
  const Zone zone = low_zone(grid, options);
  std::vector<GridStem> stems;
  if (zone.end - zone.first < 2) return stems;
  for (const Seed& seed : find_seeds(grid, zone)) {
    const Circle circle = fit_circle(grid, zone, {grid.along_m(seed.a), grid.across_m(seed.c)});
    const bool known = std::any_of(stems.begin(), stems.end(), [&](const GridStem& other) {
      return (other.foot - circle.centre).norm() < std::max(other.radius_m, circle.radius) + kSkin;
    });
    if (known) continue;
    GridStem stem;
    stem.radius_m = circle.radius;
    Contrast low;
    for (int layer = zone.first; layer < zone.end; ++layer) {
      const Contrast here = contrast_at(grid, circle.centre, circle.radius, layer);
      low.on_area = here.on_area, low.around_area = here.around_area;
      low.add(here);
    }
    stem.contrast = low.ratio();
    if (stem.contrast < options.min_contrast) continue;
    const double low_hits = std::max(1.0, low.on / (zone.end - zone.first));
    follow_up(grid, zone, circle, low_hits, options, stem);
    UpperPart upper = find_upper(grid, options, low_hits, stem);
    if (upper.share > 0.5) {
      straighten(grid, zone, circle.centre, upper, stem);
      upper = find_upper(grid, options, low_hits, stem);
      stem.top_m = top_of(grid, low_hits, upper, stem);
    }
    stem.upper_share = upper.share;
    stem.solidity = solidity_of(grid, stem);
    stems.push_back(stem);
  }
  std::sort(stems.begin(), stems.end(), [](const GridStem& a, const GridStem& b) { return a.foot.x() < b.foot.x(); });
  return stems;
}

}  // namespace rayfield::density
