#pragma once
/// simulation: simulated sites written to files, and areas against their truth.
#include <filesystem>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/sim/sim.h"

namespace rayfield::cli {

/// What to write for each date of a site.
struct SimulationOutput {
  bool log = true;   ///< scan.bag and rig.toml
  bool rays = true;  ///< rays.ply: the ray cloud as measured, with true poses
  int threads = 0;
};

/// One date that was simulated.
struct SimulatedScan {
  std::filesystem::path folder;
  std::string date, name;
  sim::SimulationSummary summary;
  double leaf_area_m2 = 0;
  std::vector<sim::Truth::Panel> panels;  ///< with their true areas
};

/// Folder of a date under the output folder: `2019-02-11` or `2019-02-11_name`.
std::string scan_folder_name(const sim::SiteDate& date);

/// Simulates every date of the site into its own folder with scan.bag, rig.toml, rays.ply and truth/.
Result<std::vector<SimulatedScan>> simulate_site(const sim::Site& site, const std::filesystem::path& folder,
                                                 const SimulationOutput& output, Progress& progress);

}  // namespace rayfield::cli
