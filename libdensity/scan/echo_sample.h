#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "libdensity/echoes/echo_statistics.h"
#include "libdensity/scan/scan_work.h"
#include "libdensity/voxels/beam_view.h"
#include "libdensity/voxels/row_segments.h"
#include "libdensity/voxels/wood.h"

namespace rayfield::density {

/// What the rays of a scan show of leaves before voxels are fitted to them.
struct SampledEchoes {
  LeafSizePairs pairs;
  std::optional<EchoStatistics> statistics;  ///< of beams that are not thin
};

/// Numbers from 0 to `count` in an order in which the first ones are spread over all.
std::vector<std::size_t> spread_order(std::size_t count);

/// Whether the echoes of more tiles would not tell more: 5000 full ones, 6000 with neighbours before and behind, and
/// 200 000 in all. Never of thin beams.
bool tells_enough(const SampledEchoes& sampled);

/// From all tiles with row segments, or, of beams that are not thin, from so many of them, spread over the block, that
/// more would not tell more (docs/beams.md, "How it is taken out"). `view`: of beams that are not thin, or nullptr.
/// Errors: those of the store; resources; interrupted.
Result<SampledEchoes> sample_echoes(ScanWork& work, const RowSegmentList& row_segments,
                                    std::span<const WoodCylinder> wood, const std::shared_ptr<const BeamView>& view);

}  // namespace rayfield::density
