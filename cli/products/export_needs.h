#pragma once

#include "cli/console/needs.h"
#include "cli/products/export_block.h"

namespace rayfield::cli {

/// What an export takes that writes everything, from what the store holds of maps, panels and half metres.
/// Errors: as export_block().
Result<Needs> export_needs(const tile::Store& store, const ExportOptions& options);

}  // namespace rayfield::cli
