#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "formats/gis/qml.h"

/// qgis: projects of QGIS, ready to be opened: layers in groups, their styles, relations, times.
namespace rayfield::formats::qgis {

/// From the first to the last moment, ISO 8601 in UTC.
struct TimeRange {
  std::string begin, end;
};

struct NamedStyle {
  std::string name;
  qml::LayerStyle style;
};

/// A layer of a project.
struct Layer {
  enum class Kind { polygon, line, point, table, raster };
  std::string id;  ///< unique in the project; letters, digits and underscores, more than ten
  std::string name;
  Kind kind = Kind::polygon;
  std::string source;              ///< as QGIS writes it, relative to the project's folder
  std::vector<NamedStyle> styles;  ///< the first is the one in use; tables have none
  TimeRange range = {};            ///< when the temporal controller shows the layer; empty: always
  bool shown = false;
};

/// A group of the layer tree: layers above groups.
struct Group {
  std::string name;
  std::vector<Layer> layers;
  std::vector<Group> groups = {};
  bool shown = true;
  bool expanded = true;
  bool one_at_a_time = false;  ///< showing one of its groups hides the others
};

/// Rows of one layer that belong to a feature of another.
struct Relation {
  std::string id, name;
  std::string parent, child;  ///< ids of layers
  std::string key;            ///< column of both
};

struct Project {
  std::string title;
  std::string crs_wkt, crs_code;  ///< "EPSG:7854"; empty: known by its WKT alone
  Eigen::AlignedBox2d extent;     ///< that is shown at first
  std::vector<Group> groups;      ///< from the top
  std::vector<Relation> relations;
  TimeRange time;        ///< of all layers with a range; empty: no temporal controller
  TimeRange first_time;  ///< that the temporal controller begins with
};

/// The text of a `.qgs` file for QGIS 3.22 and later. Equal projects are equal text: nothing in it says when and by
/// whom it was made.
std::string project_xml(const Project& project);

}  // namespace rayfield::formats::qgis
