#pragma once

/// libtile: the store of a block, a folder of immutable files and numbered snapshots (docs/store-format.md).
#include "rayfield/tile/add_options.h"     // how a scan is added, and what that gave
#include "rayfield/tile/arrays.h"          // derived data as named columns
#include "rayfield/tile/derived_writer.h"  // writes what is computed from tiles and publishes it
#include "rayfield/tile/garbage.h"         // what no snapshot names
#include "rayfield/tile/segments.h"        // rays clipped to tiles
#include "rayfield/tile/snapshot.h"        // what a store holds at one moment: scans, tiles, derived files
#include "rayfield/tile/store.h"           // create, open, add a scan, verify, gc
#include "rayfield/tile/store_config.h"    // what a store is made with
#include "rayfield/tile/tile_reader.h"     // reads the rays of a tile, chunk by chunk
