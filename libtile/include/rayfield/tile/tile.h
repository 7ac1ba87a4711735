#pragma once

/// libtile: the store of a block.
#include "rayfield/tile/arrays.h"        // derived data as named columns
#include "rayfield/tile/segments.h"      // rays clipped to tiles
#include "rayfield/tile/snapshot.h"      // what a store holds at one moment
#include "rayfield/tile/store.h"         // create, add, read, derive, verify, gc
#include "rayfield/tile/store_config.h"  // what a store is made with
