#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libdensity/echoes/echo_model.h"
#include "libdensity/ground/scan_survey.h"
#include "libdensity/scan/scan_stages.h"
#include "libdensity/scan/scan_work.h"
#include "libdensity/voxels/beam_view.h"
#include "libdensity/voxels/canopy_profile.h"
#include "libdensity/voxels/row_segments.h"
#include "libdensity/voxels/wood.h"

namespace rayfield::density {

/// Up to 3 mm at 2 m, or unknown.
bool has_thin_beam(const tile::ScanEntry& scan);

/// How the beams of a scan look at the voxels; nullptr for thin beams (up to 3 mm at 2 m), where the rig tells none and
/// where the options say so.
std::shared_ptr<const BeamView> view_of(const tile::ScanEntry& scan, const ScanSurvey& survey,
                                        const BeamOptions& options);

/// Whether its vines bear leaves: as declared, else by the month at its latitude (`crs`: of the store).
Foliage foliage_of(const tile::ScanEntry& scan, const std::string& crs);

/// What the echoes of the scan mean (kind "echoes"); nothing if there are too few to say.
Result<std::optional<EchoModel>> measure_echoes(ScanWork& work, const RowLayout& layout, const SurveyedScan& surveyed,
                                                const CanopyProfile& profile, std::span<const WoodCylinder> wood,
                                                const std::shared_ptr<const BeamView>& view);

/// `view`, knowing the range resolution that the echoes were found to have; nullptr without a model.
std::shared_ptr<const BeamView> view_with(const std::shared_ptr<const BeamView>& view,
                                          const std::optional<EchoModel>& model);

/// The same from the files of a scan that was processed before.
Result<std::optional<EchoModel>> read_echoes(const tile::Store& store, const tile::ScanEntry& scan);

/// What is known of a beam, for keys.
void add_beam(KeyBuilder& key, const LidarBeam& beam);

/// The options of integration with the error that the width of the scan's beam adds to what all voxels of a panel
/// share (docs/beams.md, "How far it can be trusted").
IntegrationOptions integration_with_beam(const IntegrationOptions& integration, const tile::ScanEntry& scan,
                                         const std::optional<EchoModel>& model);

/// What the report says of the scan's beam; empty for thin beams and where the beam is not known.
std::string beam_note(const tile::ScanEntry& scan, const std::optional<EchoModel>& model);

}  // namespace rayfield::density
