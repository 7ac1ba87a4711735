#include "cli/simulation/simulation.h"

#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "cli/simulation/staged_folder.h"
#include "rayfield/formats/formats.h"

namespace rayfield::cli {
namespace {

// The beams of the site's spun scanner as its messages describe them.
formats::ScanPattern pattern_of(const sim::Site& site) {
  const double field = site.spinning.field_of_view_deg * std::numbers::pi / 180.0;
  formats::ScanPattern pattern;
  pattern.beams = static_cast<std::size_t>(site.spinning.beams);
  pattern.angle_min_rad = -field / 2;
  pattern.angle_increment_rad = site.spinning.beams > 1 ? field / (site.spinning.beams - 1) : 0;
  pattern.time_increment_s = site.spinning.time_increment_s;
  pattern.scan_time_s = 1.0 / site.spinning.rate_hz;
  pattern.range_min_m = site.lidar.min_range_m / 2;
  pattern.range_max_m = site.lidar.max_range_m;
  return pattern;
}

// Passes the simulated messages on to a bag and keeps the first error: a SensorSink cannot return one.
class BagSink : public SensorSink {
 public:
  BagSink(formats::SensorLogWriter& writer, const sim::Site& site)
      : writer_(writer),
        pattern_(pattern_of(site)),
        spinning_(site.lidar.kind == sim::LidarKind::spinning),
        several_echoes_(site.lidar.echoes > 1),
        beams_(static_cast<std::size_t>(site.multi_beam.beams)),
        rate_rad_s_(2 * std::numbers::pi * site.spinning.spin_rate_hz) {}
  void imu(const ImuSample& sample) override { take(writer_.imu(sample)); }
  void gps(const GpsFix& fix) override { take(writer_.gps(fix)); }
  void spinner(const SpinnerAngle& angle) override { take(writer_.spinner(angle, rate_rad_s_)); }
  void lidar(const LidarScan& scan) override {
    // All beams of an azimuth follow each other, lowest first.
    for (std::size_t k = rings_.size(); !spinning_ && k < scan.range_m.size(); ++k)
      rings_.push_back(static_cast<std::uint16_t>(k % beams_));
    take(!spinning_        ? writer_.points(scan, std::span(rings_).first(scan.range_m.size()))
         : several_echoes_ ? writer_.multi_echo_scan(pattern_, scan)
                           : writer_.scan(scan.time_s, pattern_, scan.range_m, scan.intensity));
  }
  const std::optional<Error>& error() const { return error_; }

 private:
  void take(Result<void> result) {
    if (!result && !error_) error_ = std::move(result).error();
  }
  formats::SensorLogWriter& writer_;
  formats::ScanPattern pattern_;
  bool spinning_, several_echoes_;
  std::size_t beams_;
  std::vector<std::uint16_t> rings_;
  double rate_rad_s_;
  std::optional<Error> error_;
};

// Writes log, rig file, ray cloud and truth of one date into a folder that appears as a whole.
Result<SimulatedScan> simulate_date(const sim::Site& site, std::size_t index, const std::filesystem::path& folder,
                                    const SimulationOutput& output, Progress& progress) {
  const sim::SiteDate& date = site.dates[index];
  SimulatedScan scan{folder / scan_folder_name(date), date.date, date.name, {}, 0, {}};
  RAYFIELD_ASSIGN(StagedFolder staged, StagedFolder::create(scan.folder));
  const std::filesystem::path& made = staged.path();

  RAYFIELD_ASSIGN(const sim::World world, sim::build_world(site, index, output.threads, progress));
  RAYFIELD_ASSIGN(const sim::Drive drive, sim::plan_drive(world));
  RAYFIELD_ASSIGN(const sim::Truth truth, sim::truth(world, drive));
  RAYFIELD_CHECK(sim::write_truth(truth, made / "truth"));
  scan.leaf_area_m2 = truth.leaf_area_m2;
  scan.panels = truth.panels;

  const Rig rig = sim::site_rig(site);
  std::optional<formats::SensorLogWriter> log;
  std::optional<BagSink> bag;
  SensorSink nowhere;
  if (output.log) {
    RAYFIELD_CHECK(formats::write_rig((made / "rig.toml").string(), rig));
    // A third of the size, in no time that could be noticed.
    const formats::BagWriteOptions compressed{.compression = formats::BagCompression::lz4};
    auto opened = formats::SensorLogWriter::create((made / "scan.bag").string(), rig, compressed);
    if (!opened) return tl::make_unexpected(std::move(opened).error());
    log.emplace(std::move(*opened));
    bag.emplace(*log, site);
  }
  std::optional<formats::PlyWriter> cloud;
  sim::RayCallback on_rays;
  if (output.rays) {
    auto opened = formats::PlyWriter::create((made / "rays.ply").string(), {site.crs_code(), rig.lidar.beam});
    if (!opened) return tl::make_unexpected(std::move(opened).error());
    cloud.emplace(std::move(*opened));
    on_rays = [&cloud](const RayBatch& batch) { return cloud->write(batch); };
  }
  RAYFIELD_ASSIGN(scan.summary, sim::simulate(world, drive, bag ? static_cast<SensorSink&>(*bag) : nowhere, on_rays,
                                              {output.threads}, progress));
  if (bag && bag->error()) return tl::make_unexpected(*bag->error());
  if (log) RAYFIELD_CHECK(log->close());
  if (cloud) RAYFIELD_CHECK(cloud->close());
  RAYFIELD_CHECK(staged.publish());
  return scan;
}

}  // namespace

std::string scan_folder_name(const sim::SiteDate& date) {
  return date.name.empty() ? date.date : date.date + "_" + date.name;
}

Result<std::vector<SimulatedScan>> simulate_site(const sim::Site& site, const std::filesystem::path& folder,
                                                 const SimulationOutput& output, Progress& progress) {
  std::vector<SimulatedScan> scans;
  for (std::size_t index = 0; index < site.dates.size(); ++index) {
    RAYFIELD_ASSIGN(SimulatedScan scan, simulate_date(site, index, folder, output, progress));
    scans.push_back(std::move(scan));
  }
  return scans;
}

}  // namespace rayfield::cli
