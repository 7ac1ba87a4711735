#pragma once

#include <cstdint>

#include "cli/console/needs.h"
#include "cli/simulation/simulation.h"

namespace rayfield::cli {

/// What is to be simulated.
struct SimulationNeeds {
  double duration_s = 0;    ///< of all drives together
  std::uint64_t beams = 0;  ///< of the lidar
  Needs needs;
};

/// Plans the drives of all dates, through vines without leaves: seconds. Errors: as simulate_site().
Result<SimulationNeeds> simulation_needs(const sim::Site& site, const SimulationOutput& output, Progress& progress);

}  // namespace rayfield::cli
