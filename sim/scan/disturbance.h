#pragma once

#include <optional>

#include "rayfield/sim/random.h"
#include "rayfield/sim/site.h"
#include "sim/scan/echoes.h"

namespace rayfield::sim {

/// Chance that an echo gets lost: lost_echo_share at the detectable energy, falling linearly to nothing at twice it.
double chance_of_loss(const SiteDisturbance& disturbance, double energy, double detectable);

/// What dust, rain and spurious returns leave of a beam: `echo` itself, or something weak in its place. Dust and drops
/// shade what lies behind them; a spurious return stands anywhere within the lidar's range.
std::optional<Echo> disturbed(const Site& site, const std::optional<Echo>& echo, CounterRandom& random);

}  // namespace rayfield::sim
