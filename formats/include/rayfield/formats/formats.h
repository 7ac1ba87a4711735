#pragma once

/// Readers and writers at the edge: one header per format.

// Products for GIS and for people (docs/products.md)
#include "rayfield/formats/color.h"       // ramps and the fixed colour scale of each product
#include "rayfield/formats/geotiff.h"     // rasters as Cloud Optimised GeoTIFF, sections in a local frame
#include "rayfield/formats/geopackage.h"  // a block with all its dates as one GeoPackage
#include "rayfield/formats/picture.h"     // plan views, side views and end-on sections as PNG
#include "rayfield/formats/canvas.h"      // points, lines and text on a PNG of one's own
#include "rayfield/formats/exchange.h"    // GeoJSON and CSV

// Logs of a drive (docs/rosbag.md)
#include "rayfield/formats/log_info.h"           // what is in a log, its problems, a proposed rig file

// Logs and ray clouds (docs/rosbag.md, docs/ray-cloud-ply.md, docs/rig.md)
#include "rayfield/formats/log_info.h"           // what is in a log, and a rig file proposed for it
#include "rayfield/formats/ply_reader.h"         // ray clouds of raycloudtools
#include "rayfield/formats/ply_writer.h"
#include "rayfield/formats/rig_file.h"           // the sensors of a vehicle
#include "rayfield/formats/rosbag_reader.h"      // the container of ROS 1 bags
#include "rayfield/formats/rosbag_writer.h"
#include "rayfield/formats/sensor_log.h"         // the sensors of a rig from a bag
#include "rayfield/formats/sensor_log_writer.h"  // and into one
#include "rayfield/formats/trajectory_file.h"    // poses as text
