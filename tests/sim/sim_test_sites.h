#pragma once

#include <gtest/gtest.h>

#include "rayfield/sim/sim.h"

namespace rayfield::sim {

/// A block small enough for unit tests, with everything in it.
inline Site small_site() {
  Site site;
  site.name = "small";
  site.seed = 5;
  site.terrain.slope_percent = 4;
  site.terrain.slope_azimuth_deg = 30;
  site.terrain.relief_m = 0.3;
  site.rows.count = 2;
  site.rows.length_m = 13;
  site.rows.azimuth_deg = 20;
  site.canopy.leaf_area_m2_per_m = 1.5;
  site.surroundings.trees = 2;
  SiteDate date;
  date.date = "2019-02-11";
  date.stationary_start_s = 1;
  date.speed_m_s = 2.5;
  site.dates = {date};
  return site;
}

/// The same with hardly any lidar, for what concerns the other sensors.
inline Site small_site_without_lidar() {
  Site site = small_site();
  site.spinning.beams = 2;
  return site;
}

/// Flat bare ground, no plants, no trellis wires, nothing around; posts remain.
inline Site bare_site() {
  Site site = small_site();
  site.terrain = SiteTerrain();
  site.terrain.bank_height_m = site.terrain.roughness_m = site.terrain.grass_per_m2 = 0;
  site.rows.missing_fraction = 1;
  site.structure.wire_heights_m.clear();
  site.surroundings = {0, 0, false};
  return site;
}

template <class T>
T take(Result<T> result) {
  if (!result) {
    ADD_FAILURE() << result.error().line();
    std::abort();
  }
  return std::move(*result);
}

inline World make_world(const Site& site, std::size_t date = 0) {
  Progress progress;
  return take(build_world(site, date, 1, progress));
}

}  // namespace rayfield::sim
