#include "tests/libdensity/scene.h"

#include <cmath>

namespace rayfield::density::testing {

Eigen::Vector2d BlockShape::at(double share, double across_m) const {
  const double azimuth = azimuth_deg * M_PI / 180;
  const Eigen::Vector2d u(std::sin(azimuth), std::cos(azimuth)), left(-u.y(), u.x());
  if (radius_m <= 0) return start + u * (share * length_m) + left * across_m;
  // Turning left about a centre on the left; the angle is the same for all rows.
  const double angle = share * length_m / radius_m, r = radius_m - across_m;
  return start + left * radius_m - left * (r * std::cos(angle)) + u * (r * std::sin(angle));
}

Scene::Scene(std::uint64_t seed, Height ground) : random_(seed), ground_(std::move(ground)) {}

void Scene::add_ground(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double per_m2, double noise_m) {
  const Eigen::Vector2d size = high - low;
  const int n = static_cast<int>(size.x() * size.y() * per_m2);
  for (int i = 0; i < n; ++i) {
    const double x = low.x() + uniform(0, size.x()), y = low.y() + uniform(0, size.y());
    points_.emplace_back(x, y, ground_(x, y) + normal(noise_m));
  }
}

void Scene::add_canopy(const BlockShape& block, double across_m, double from_share, double to_share, double per_m,
                       double sigma_across_m, double bottom_m, double top_m) {
  const int n = static_cast<int>(per_m * block.length_m * (to_share - from_share));
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector2d p = block.at(uniform(from_share, to_share), across_m + normal(sigma_across_m));
    points_.emplace_back(p.x(), p.y(), ground(p) + uniform(bottom_m, top_m));
  }
}

void Scene::add_cylinder(const Eigen::Vector2d& foot, double radius_m, double top_m, double per_m,
                         const Eigen::Vector2d& lean) {
  const int n = static_cast<int>(per_m * top_m);
  for (int i = 0; i < n; ++i) {
    const double angle = uniform(0, 2 * M_PI), h = uniform(0, top_m), r = radius_m + normal(0.01);
    const Eigen::Vector2d p = foot + lean * h + r * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    points_.emplace_back(p.x(), p.y(), ground(foot) + h);
  }
}

void Scene::add_drive(const std::vector<Eigen::Vector2d>& line) {
  constexpr double kStep = 0.05;  // m between rays
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector2d d = line[i] - line[i - 1];
    const int n = std::max(1, static_cast<int>(std::lround(d.norm() / kStep)));
    for (int k = 0; k < n; ++k) {
      const Eigen::Vector2d p = line[i - 1] + d * (static_cast<double>(k) / n);
      origins_.emplace_back(p.x(), p.y(), ground(p) + 1.8);
      times_.push_back(clock_s_);
      clock_s_ += kStep / 1.25;
    }
  }
}

void Scene::drive_lanes(const BlockShape& block, const std::vector<double>& lanes_across_m) {
  std::vector<Eigen::Vector2d> line;
  const double over = 3.0 / block.length_m;
  for (std::size_t lane = 0; lane < lanes_across_m.size(); ++lane) {
    const bool back = lane % 2 == 1;
    if (lane > 0) {  // half a circle from the last lane to this one
      const double share = back ? 1 + over : -over, from = lanes_across_m[lane - 1], to = lanes_across_m[lane];
      const double reach = 0.5 * std::abs(to - from) / block.length_m * (back ? 1 : -1);
      for (int k = 1; k < 12; ++k) {
        const double a = M_PI * k / 12;
        line.push_back(block.at(share + reach * std::sin(a), from + (to - from) * 0.5 * (1 - std::cos(a))));
      }
    }
    for (int k = 0; k <= 80; ++k) {
      const double share = -over + (1 + 2 * over) * k / 80;
      line.push_back(block.at(back ? 1 - share : share, lanes_across_m[lane]));
    }
  }
  add_drive(line);
}

Tiles Scene::tiles() const {
  constexpr double kMargin = 0.25;
  Tiles out;
  const auto tile_of = [](double v) { return static_cast<std::int32_t>(std::floor(v / kTile)); };
  const auto push = [&](tile::TileIndex index, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double time_s,
                        int flags) {
    tile::SegmentBatch& batch = out[index];
    batch.entry.push_back(from), batch.exit.push_back(to), batch.time_s.push_back(time_s);
    batch.intensity.push_back(0), batch.flags.push_back(static_cast<std::uint8_t>(flags));
  };
  for (const Eigen::Vector3d& p : points_) {
    const tile::TileIndex home{tile_of(p.x()), tile_of(p.y())};
    for (std::int32_t ix = tile_of(p.x() - kMargin); ix <= tile_of(p.x() + kMargin); ++ix)
      for (std::int32_t iy = tile_of(p.y() - kMargin); iy <= tile_of(p.y() + kMargin); ++iy) {
        const tile::TileIndex index{ix, iy};
        push(index, p + Eigen::Vector3d(0, 0, 0.4), p, 1.55e9, tile::kHit | (index == home ? tile::kEndsHere : 0));
      }
  }
  for (std::size_t i = 0; i < origins_.size(); ++i)
    push({tile_of(origins_[i].x()), tile_of(origins_[i].y())}, origins_[i], origins_[i] + Eigen::Vector3d(0, 0, 40),
         times_[i], tile::kStartsHere | tile::kEndsHere);
  return out;
}

std::vector<TileSurvey> survey_all(const Tiles& tiles) {
  std::vector<TileSurvey> surveys;
  for (const auto& [index, batch] : tiles) {
    SurveyAccumulator sum({index, kTile}, {});
    sum.add(batch);
    surveys.push_back(sum.finish());
  }
  return surveys;
}

std::vector<const TileSurvey*> pointers(const std::vector<TileSurvey>& surveys) {
  std::vector<const TileSurvey*> out;
  for (const TileSurvey& survey : surveys) out.push_back(&survey);
  return out;
}

ScanSurvey scan_survey_of(const std::vector<TileSurvey>& surveys) {
  ScanSurvey out;
  for (const TileSurvey& survey : surveys) out.add(survey);
  return out;
}

GroundModel ground_of(const std::vector<TileSurvey>& surveys) {
  GroundModel model(kTile);
  for (const TileSurvey& survey : surveys)
    model.set(survey.index, estimate_ground(survey.index, pointers(surveys), {}).value().nodes);
  return model;
}

tile::HitBatch hits_of(const tile::SegmentBatch& segments) {
  tile::HitBatch hits;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if ((segments.flags[i] & tile::kHit) == 0) continue;
    hits.end.push_back(segments.exit[i]), hits.flags.push_back(segments.flags[i]);
  }
  return hits;
}

CanopyMap canopy_of(const Tiles& tiles, const GroundModel& ground) {
  CanopyMap map(kTile);
  for (const auto& [index, batch] : tiles) {
    CanopyAccumulator sum({index, kTile}, ground, {});
    sum.add(hits_of(batch));
    map.set(index, sum.finish());
  }
  return map;
}

std::vector<Stem> stems_of(const Tiles& tiles, const RowLayout& layout, const GroundModel& ground) {
  std::vector<Stem> stems;
  for (const auto& [index, batch] : tiles) {
    StemAccumulator sum({index, kTile}, layout, ground, {});
    sum.add(hits_of(batch));
    const auto more = sum.finish();
    stems.insert(stems.end(), more.begin(), more.end());
  }
  return stems;
}

CanopyProfile profile_of(const Tiles& tiles, const RowLayout& layout, const GroundModel& ground,
                         const RowSegmentOptions& options) {
  CanopyProfile total;
  for (const auto& [index, batch] : tiles) {
    CanopyProfileAccumulator sum({index, kTile}, layout, ground, options);
    sum.add(hits_of(batch));
    add_profile(total, sum.finish());
  }
  return total;
}

RowLayout two_rows(const BlockShape& block, double spacing_m) {
  RowLayout layout;
  for (int i = 0; i < 2; ++i) {
    Row row;
    for (int k = 0; k <= 60; ++k) row.centreline.push_back(block.at(k / 60.0, -i * spacing_m));
    layout.rows.push_back(row);
  }
  number_rows(layout);
  return layout;
}

GroundModel exact_ground(const Height& height) {
  GroundModel model(kTile);
  for (int ix = 19999; ix <= 20003; ++ix)
    for (int iy = 244000; iy <= 244004; ++iy) {
      Grid2<float> nodes(Eigen::Vector2d(ix, iy) * kTile, 0.25, 101, 101);
      for (int y = 0; y < 101; ++y)
        for (int x = 0; x < 101; ++x)
          nodes.at(x, y) = static_cast<float>(height(nodes.origin.x() + 0.25 * x, nodes.origin.y() + 0.25 * y));
      model.set({ix, iy}, nodes);
    }
  return model;
}

Found find_rows_in(const Scene& scene) {
  Found out;
  out.tiles = scene.tiles();
  const auto surveys = survey_all(out.tiles);
  out.ground = ground_of(surveys);
  out.rows = find_rows(scan_survey_of(surveys).path(), canopy_of(out.tiles, out.ground), {}).value();
  return out;
}

}  // namespace rayfield::density::testing
