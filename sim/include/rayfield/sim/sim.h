#pragma once

/// Synthetic vineyards with known leaf area: what rayfield is tested against.
///
///   read_site()    SITE.toml → Site                                   site.h
///   build_world()  Site, date → World: triangles ready for rays       world.h, terrain.h, block_geometry.h
///   plan_drive()   World → Drive: the true motion of the vehicle      drive.h, trajectory.h, uniform_spline.h
///   simulate()     World, Drive → sensor messages and true rays       simulate.h
///   true_rays()    World, Drive → RaySource                           simulate.h
///   truth()        World, Drive → what an estimator should find       truth.h
///
/// Everything is a pure function of the site file: the same file gives the same bytes at any thread count (random.h).
/// Frames: ENU is local east-north-up at the site's latitude, longitude and height; map is its projected CRS.
#include "rayfield/sim/block_geometry.h"
#include "rayfield/sim/drive.h"
#include "rayfield/sim/leaf_angles.h"
#include "rayfield/sim/random.h"
#include "rayfield/sim/simulate.h"
#include "rayfield/sim/site.h"
#include "rayfield/sim/terrain.h"
#include "rayfield/sim/trajectory.h"
#include "rayfield/sim/truth.h"
#include "rayfield/sim/world.h"
