#pragma once

#include <optional>
#include <span>

#include "libdensity/echoes/echo_model.h"
#include "libdensity/scan/scan_work.h"
#include "libdensity/voxels/canopy_profile.h"
#include "libdensity/voxels/wood.h"

namespace rayfield::density {

/// Side of the scan's voxels, m: as given, or fitted to the leaves of the model, or else to those that a sample of the
/// rays shows (kind "voxelsize").
Result<double> choose_voxel_size(ScanWork& work, const RowLayout& layout, const GroundModel& ground,
                                 const CanopyProfile& profile, std::span<const WoodCylinder> wood,
                                 const std::optional<EchoModel>& model);

}  // namespace rayfield::density
