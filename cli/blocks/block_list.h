#pragma once

#include <string>
#include <vector>

#include "cli/blocks/update_block.h"
#include "rayfield/core/result.h"

namespace rayfield::cli {

/// A list of blocks to update (docs/commands.md):
///
///   [[block]]
///   store = "north"                 # folders and files from where the list lies
///   inputs = ["north/scan.bag"]
///   rig = "rig.toml"                # for logs
///   trajectory = "path.tum"         # for LAS clouds
///   date = 2019-02-11               # a date of TOML, or a text
///   name = "veraison"               # optional, as --name
///   output = "maps/north"           # optional, as -o
///   crs = "EPSG:7854"               # optional: makes the store where there is none
///   set = ["posts.min_contrast=2.5"]  # optional, as --set
///
/// `name`: of the text, in messages and for the folder it lies in. Errors: usage, with the line: unknown or missing
/// keys, other types, dates that are none, no block.
Result<std::vector<BlockUpdate>> parse_block_list(const std::string& text, const std::string& name);

}  // namespace rayfield::cli
