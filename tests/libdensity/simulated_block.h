#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "rayfield/density/density.h"
#include "rayfield/sim/sim.h"
#include "rayfield/tile/tile.h"

/// Stores of a simulated block of two short rows, with the rays of drives on different dates in memory.
namespace rayfield::density::testing {

template <class T>
T take(Result<T> result) {
  if (!result) {
    ADD_FAILURE() << result.error().line();
    std::abort();
  }
  return std::move(*result);
}

class MemorySource : public RaySource {
 public:
  explicit MemorySource(const RayBatch& rays) : rays_(rays) {}
  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override {
    batch.clear();
    for (; next_ < rays_.size() && batch.size() < max_rays; ++next_)
      batch.push(rays_.origin[next_], rays_.end[next_], rays_.time_s[next_], rays_.intensity[next_],
                 rays_.hit[next_] != 0);
    return batch.size();
  }
  Result<bool> rewind() override {
    next_ = 0;
    return true;
  }
  std::string name() const override { return "memory"; }

 private:
  const RayBatch& rays_;
  std::size_t next_ = 0;
};

/// A drive past the block.
struct Drive {
  RayBatch rays;
  double leaf_area_m2 = 0, wood_area_m2 = 0;  ///< true, of the block
  std::vector<sim::RowCanopy> canopy;         ///< true, of each row
};

/// The block on one date.
inline sim::Site block_site(double leaf_fraction, std::uint64_t seed) {
  sim::Site site;
  site.name = "block", site.seed = 5;
  site.latitude_deg = -35.2186, site.longitude_deg = 138.5411;
  site.terrain.slope_percent = 3, site.terrain.slope_azimuth_deg = 40;
  site.rows.count = 2, site.rows.length_m = 14, site.rows.spacing_m = 2.5, site.rows.azimuth_deg = 70;
  site.rows.panel_length_m = 3.5;
  site.canopy.leaf_area_m2_per_m = 1.8;
  site.surroundings = {1, 0, false};
  site.spinning.beams = 143;
  sim::SiteDate date;
  date.date = "2019-08-01", date.leaf_fraction = leaf_fraction, date.seed = seed;
  date.stationary_start_s = 1, date.speed_m_s = 1.5;
  site.dates = {date};
  return site;
}

/// The only drive of a site.
inline Drive drive_past(const sim::Site& site) {
  Drive drive;
  Progress progress;
  const sim::World world = take(sim::build_world(site, 0, 0, progress));
  for (const sim::RowAreas& row : world.areas())
    for (std::size_t i = 0; i < row.panels.leaf_m2.size(); ++i)
      drive.leaf_area_m2 += row.panels.leaf_m2[i], drive.wood_area_m2 += row.panels.wood_m2[i];
  drive.canopy = world.canopy();
  const auto plan = take(sim::plan_drive(world));
  SensorSink nowhere;
  const auto keep = [&](const RayBatch& rays) -> Result<void> {
    for (std::size_t i = 0; i < rays.size(); ++i)
      drive.rays.push(rays.origin[i], rays.end[i], rays.time_s[i], rays.intensity[i], rays.hit[i] != 0);
    return {};
  };
  take(sim::simulate(world, plan, nowhere, keep, {}, progress));
  return drive;
}

/// Drives are made once and kept for the program.
inline const Drive& drive_with(double leaf_fraction, std::uint64_t seed) {
  static std::map<std::pair<double, std::uint64_t>, Drive> drives;
  const auto [place, is_new] = drives.try_emplace({leaf_fraction, seed});
  if (is_new) place->second = drive_past(block_site(leaf_fraction, seed));
  return place->second;
}

/// A store that goes with its end.
class Block {
 public:
  Block() {
    std::string name = (std::filesystem::temp_directory_path() / "rayfield-density-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    folder_ = name;
    tile::StoreConfig config;
    config.crs = "EPSG:7854";
    store_ = std::make_unique<tile::Store>(take(tile::Store::create(folder_ / "block", config)));
  }
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;
  ~Block() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  tile::Store& store() { return *store_; }
  void add(const std::string& date, const Drive& drive, std::optional<bool> dormant = std::nullopt,
           std::optional<LidarBeam> beam = std::nullopt) {
    tile::AddOptions options;
    options.date = date, options.dormant = dormant, options.overwrite = true, options.beam = beam;
    MemorySource memory(drive.rays);
    const auto restored = take(MissingRaySource::create(memory, {}));
    Progress progress;
    take(store_->add(*restored, options, progress));
  }
  ProcessReport process(const std::vector<std::string>& dates = {}, ProcessOptions options = {}) {
    options.dates = dates;
    Progress progress;
    return take(density::process(*store_, options, "test", progress));
  }
  tile::Snapshot snapshot() const { return take(store_->latest()); }
  ScanResults results(const std::string& scan_id) const {
    return take(load_block(*store_, snapshot(), {scan_id})).scans.at(0);
  }
  /// Path of every derived file of a scan; it has the hash of what is in it.
  std::map<std::string, std::string> derived(const std::string& scan_id) const {
    std::map<std::string, std::string> files;
    const tile::Snapshot now = snapshot();
    for (const tile::DerivedEntry& entry : now.find_scan(scan_id)->derived)
      files[entry.kind + "/" + entry.name] = entry.file.path;
    return files;
  }

 private:
  std::filesystem::path folder_;
  std::unique_ptr<tile::Store> store_;
};

}  // namespace rayfield::density::testing
