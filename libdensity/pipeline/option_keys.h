#pragma once

#include "libdensity/pipeline/derive.h"
#include "rayfield/density/process.h"

namespace rayfield::density {

/// Hashes of parameters, part of the keys of derived files: everything in the struct, in the order of its members.
KeyBuilder& add_options(KeyBuilder& key, const SurveyOptions& options);
KeyBuilder& add_options(KeyBuilder& key, const GroundOptions& options);
KeyBuilder& add_options(KeyBuilder& key, const CanopyMapOptions& options);
KeyBuilder& add_options(KeyBuilder& key, const RowOptions& options);
KeyBuilder& add_options(KeyBuilder& key, const PostOptions& options);
KeyBuilder& add_options(KeyBuilder& key, const RowSegmentOptions& options);
KeyBuilder& add_options(KeyBuilder& key, const VoxelOptions& options);
KeyBuilder& add_options(KeyBuilder& key, const VoxelFitOptions& options);
KeyBuilder& add_options(KeyBuilder& key, const EstimatorOptions& options);
KeyBuilder& add_options(KeyBuilder& key, const IntegrationOptions& options);
KeyBuilder& add_options(KeyBuilder& key, const PlanRasterOptions& options);

}  // namespace rayfield::density
