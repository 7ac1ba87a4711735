#pragma once

/// libdensity: from the tiles of a block to canopy density. What programs need of it:
#include "rayfield/density/comparison.h"      // two dates against each other
#include "rayfield/density/estimator.h"       // the estimators, from sums over rays
#include "rayfield/density/findings.h"        // gaps and weak stretches of one date
#include "rayfield/density/landmarks.h"       // what of a block does not grow, to lay scans on each other
#include "rayfield/density/layout_options.h"  // options of the stages up to the block's layout
#include "rayfield/density/load.h"            // what process() left in the store, as products
#include "rayfield/density/missing_rays.h"    // restores the rays that clouds leave out
#include "rayfield/density/options.h"         // options of voxels, density and maps, and all of them together
#include "rayfield/density/process.h"         // runs all stages over a store
#include "rayfield/density/registry.h"        // rows, panels, posts: what they are called, what a scan is aligned to
#include "rayfield/density/season.h"          // rows and block through all dates
#include "rayfield/density/voxel_block.h"     // from rays to density in one block of voxels, without a store

/// How it is done stands in the folders of the library, in this order, each using only those before it:
///   options      what can be set, and whether it fits together
///   tiles        reading tiles chunk by chunk, reading and writing derived data
///   ray_filters  rays that clouds leave out
///   ground       one reading of every tile: survey, trajectory, ground
///   layout       rows beside the vehicle's passes, posts, trunks, panels
///   voxels       row segments with their voxel grids; rays, hits and path lengths per voxel; how large leaves are
///   estimate     from counts to density, from density to panels, sections and maps
///   season       what changes from date to date
///   pipeline     the stages one after the other over a store that keeps what each of them made
