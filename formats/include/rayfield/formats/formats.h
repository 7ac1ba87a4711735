#pragma once

/// Readers and writers at the edge: one header per format.

// Logs of a drive (docs/rosbag.md)
#include "rayfield/formats/log_info.h"           // what is in a log, and its problems
#include "rayfield/formats/rig_proposal.h"       // a rig file to start from, made from that
#include "rayfield/formats/rosbag_reader.h"      // the container: messages of a ROS 1 bag, damaged ones too
#include "rayfield/formats/rosbag_writer.h"      // the same, written with index
#include "rayfield/formats/sensor_log.h"         // reads the sensors of a rig from a log
#include "rayfield/formats/sensor_log_report.h"  // what became of a log's messages
#include "rayfield/formats/sensor_log_writer.h"  // writes the sensors of a rig to a log

// Ray clouds (docs/ray-cloud-ply.md, docs/ray-cloud-las.md)
#include "rayfield/formats/las_info.h"    // what is in a LAS file
#include "rayfield/formats/las_reader.h"  // a stream of rays from LAS and a trajectory
#include "rayfield/formats/ply_reader.h"  // a stream of rays from raycloudtools PLY
#include "rayfield/formats/ply_writer.h"  // the same, written

// Text files
#include "rayfield/formats/rig_file.h"         // how the sensors of a vehicle are mounted (docs/rig.md)
#include "rayfield/formats/text_output.h"      // any text, whole or not at all
#include "rayfield/formats/trajectory_file.h"  // poses after the TUM convention

// Products for GIS and for people (docs/products.md)
#include "rayfield/formats/chart.h"           // dates of a block as charts, PNG and SVG
#include "rayfield/formats/draw_zones.h"      // management zones as polygons
#include "rayfield/formats/exchange.h"        // panels as GeoJSON, KML, FlatGeobuf, GeoParquet, shapefile and CSV
#include "rayfield/formats/farm_profile.h"    // what farm management systems take
#include "rayfield/formats/geopackage.h"      // a block with all its dates as one GeoPackage
#include "rayfield/formats/geotiff.h"         // rasters as Cloud Optimised GeoTIFF
#include "rayfield/formats/isoxml.h"          // a prescription map as ISO 11783-10 task
#include "rayfield/formats/picture.h"         // plan views, side views and end-on sections as PNG
#include "rayfield/formats/point_cloud.h"     // hits coloured by density, as PLY and LAS
#include "rayfield/formats/product_folder.h"  // products that appear in a folder together
#include "rayfield/formats/rates_file.h"      // rates for management zones
#include "rayfield/formats/reference_file.h"  // surveyed rows and posts from GeoPackage, GeoJSON, CSV
#include "rayfield/formats/registry_file.h"   // the rows and posts of the registry, written
#include "rayfield/formats/report.h"          // a block with all its dates as one HTML document
#include "rayfield/formats/scale_fit.h"       // one colour scale for all dates of a block
#include "rayfield/formats/season_tables.h"   // what changed between dates: GeoPackage and CSV
#include "rayfield/formats/stac.h"            // the maps of a block as a STAC catalogue
#include "rayfield/formats/style.h"           // their colours, lines and text
#include "rayfield/formats/zone_map.h"        // management zones as GeoPackage, GeoJSON and shapefile
