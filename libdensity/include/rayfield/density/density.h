#pragma once

/// libdensity: from the tiles of a block to canopy density.
#include "rayfield/density/load.h"     // what process() left in the store, as products
#include "rayfield/density/process.h"  // everything below, in order, over a store

#include "rayfield/density/canopy_map.h"    // hits in plan by height
#include "rayfield/density/estimator.h"     // from counts to density
#include "rayfield/density/ground.h"        // ground from the lifted lower hull
#include "rayfield/density/integrate.h"     // panels, half metres, sections
#include "rayfield/density/passes.h"        // the trajectory cut into drives along lanes
#include "rayfield/density/plan_raster.h"   // maps
#include "rayfield/density/posts.h"         // posts, trunks, panels
#include "rayfield/density/row_density.h"   // the density of a row
#include "rayfield/density/row_segments.h"  // voxel grids that follow row and ground
#include "rayfield/density/rows.h"          // rows beside the drives
#include "rayfield/density/survey.h"        // one pass over a tile: low points, path, coverage
#include "rayfield/density/voxel_grid.h"    // rays, hits and path lengths per voxel
