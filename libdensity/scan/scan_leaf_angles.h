#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "libdensity/echoes/echo_model.h"
#include "libdensity/leaf_angles/leaf_angle_fit.h"
#include "libdensity/scan/scan_work.h"
#include "libdensity/voxels/beam_view.h"
#include "libdensity/voxels/row_segments.h"
#include "libdensity/voxels/wood.h"

namespace rayfield::density {

/// How the leaves of the scan are turned (kind "leaf_angles", docs/density.md), from up to 16 of its row segments.
/// `view` and `echoes`: of beams that are not thin. Nothing is measured where the options say the angles, for the
/// published method, and where wide beams are counted: what is apparent then goes with their width.
Result<LeafAngleFit> measure_leaf_angles(ScanWork& work, const RowLayout& layout, const GroundModel& ground,
                                         const CanopyProfile& profile, std::span<const WoodCylinder> wood,
                                         const std::shared_ptr<const BeamView>& view,
                                         const std::optional<EchoModel>& echoes);

/// The same from the files of a scan that was processed before.
Result<LeafAngleFit> read_leaf_angles(const tile::Store& store, const tile::ScanEntry& scan);

/// What the report says where leaves are not taken for spherical because of what was measured; else empty.
std::string leaf_angle_note(const tile::ScanEntry& scan, const LeafAngleFit& fit);

}  // namespace rayfield::density
