#pragma once

/// Synthetic vineyards with known leaf area: what rayfield is tested against.
///
///   read_site()    SITE.toml → Site                                   site_toml.h, site.h
///   build_world()  Site, date → World: triangles ready for rays       world.h, vineyard.h
///   plan_drive()   World → Drive: the true motion of the vehicle      drive.h
///   simulate()     World, Drive → sensor messages and true rays       simulate.h
///   truth()        World, Drive → what an estimator should find       truth.h, truth_files.h
///
/// Everything is a pure function of the site file: the same file gives the same bytes at any thread count.
/// Frames: ENU is local east-north-up at the site's latitude, longitude and height; map is its projected CRS.
#include "rayfield/sim/drive.h"
#include "rayfield/sim/simulate.h"
#include "rayfield/sim/site.h"
#include "rayfield/sim/site_toml.h"
#include "rayfield/sim/truth.h"
#include "rayfield/sim/truth_files.h"
#include "rayfield/sim/vineyard.h"
#include "rayfield/sim/world.h"
