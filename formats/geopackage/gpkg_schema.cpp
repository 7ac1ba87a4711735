#include "formats/geopackage/gpkg_schema.h"

#include <algorithm>

#include "formats/gis/descriptor_columns.h"
#include "formats/gis/measured_columns.h"

namespace rayfield::formats::gpkg {
namespace {

const Column kPanelUid{"panel_uid", OFTString, "UUID of the panel, the same on all dates"};
const Column kRowNumber{"row_number", OFTInteger, "number of the row in the block, from 1"};
const Column kPanelNumber{"panel_number", OFTInteger, "number of the panel along its row, from 1"};
const Column kPanelLength{"length_m", OFTReal, "length of the panel along the row, m"};
const Column kRowName{"row_name", OFTString, "the farm's name for the row; empty if it has none"};
const Column kValidFrom{"valid_from", OFTDate, "known to stand from this date on; NULL: always"};
const Column kValidTo{"valid_to", OFTDate, "gone from this date on; NULL: still there"};
const Column kSource{"source", OFTString, "surveyed, or the scan that it was found in"};
const Column kScanId{"scan_id", OFTString, "identifier of the scan, see table scan"};
const Column kScanDate{"scan_date", OFTDate, "local date of the scan"};

void add_descriptors(Table& table) {
  for (const DescriptorColumn& column : kDescriptorColumns)
    table.columns.push_back({column.name, OFTReal, column.description});
}

void add_measured_columns(Table& table) {
  for (const MeasuredColumn& column : kMeasuredColumns)
    table.columns.push_back({column.name, OFTReal, column.description});
  table.columns.push_back({"ray_count", OFTInteger64, "rays through the panel"});
  table.columns.push_back({"wood_scan_id", OFTString, kWoodScanDescription});
  add_descriptors(table);
  table.columns.push_back({"wood_from", OFTString, kWoodFromDescription});
}

}  // namespace

Table vine_row_table() {
  return {"vine_row",
          "Centrelines of the rows of vines",
          wkbLineString,
          {{"row_uid", OFTString, "UUID of the row, the same on all dates"},
           kRowNumber,
           {"length_m", OFTReal, "length of the row, m"},
           {"spacing_m", OFTReal, "mean distance to the neighbouring rows, m; NULL for a single row"},
           kRowName,
           kValidFrom,
           kValidTo,
           kSource}};
}

Table panel_table() {
  return {"panel",
          "Panels: spans of a row between two posts",
          wkbPolygon,
          {kPanelUid,
           kRowNumber,
           kPanelNumber,
           kPanelLength,
           {"chainage_start_m", OFTReal, "start of the panel along the row's centreline, m"},
           {"chainage_end_m", OFTReal, "end of the panel along the row's centreline, m"},
           kRowName,
           kValidFrom,
           kValidTo,
           kSource}};
}

Table post_table() {
  return {"post",
          "Trellis posts",
          wkbPoint,
          {{"post_uid", OFTString, "UUID of the post, the same on all dates"},
           kRowNumber,
           {"chainage_m", OFTReal, "position along the row's centreline, m"},
           {"ground_m", OFTReal, "height of the ground at the post, m"},
           {"height_m", OFTReal, "height of the post above the ground, m"},
           {"detected", OFTInteger, "1: seen in a scan, 0: placed where the regular spacing or the survey wants one"},
           kRowName,
           kValidFrom,
           kValidTo,
           kSource}};
}

Table block_table() {
  return {"block",
          "The block and what it is called",
          wkbNone,
          {{"block", OFTString, "name of the block"},
           {"farm", OFTString, "name of the farm; empty if not given"},
           {"variety", OFTString, "variety grown; empty if not given"}}};
}

Table scan_table() {
  return {"scan",
          "Scans (dates) of the block",
          wkbNone,
          {{"scan_id", OFTString, "identifier of the scan"},
           kScanDate,
           {"name", OFTString, "name given by the user"},
           {"start_utc", OFTDateTime, "time of the first ray, UTC"},
           {"end_utc", OFTDateTime, "time of the last ray, UTC"},
           {"ray_count", OFTInteger64, "rays in the scan"},
           {"offset_e_m", OFTReal, "how far the scan's middle was moved east onto the block's reference, m"},
           {"offset_n_m", OFTReal, "how far it was moved north, m"},
           {"offset_h_m", OFTReal, "how far it was moved up, m"},
           {"yaw_mrad", OFTReal, "how far it was turned, from east to north, mrad"},
           {"residual_m", OFTReal, "distance in plan of posts and trunks from those of the reference, rms, m"},
           {"landmarks", OFTInteger, "posts and trunks that both show"},
           {"aligned", OFTInteger, "1: it lies on the reference, 0: it lies where its positioning put it"},
           {"wood_scan_id", OFTString, kWoodScanDescription},
           {"leaf_note", OFTString, "what the leaf areas of the scan hold, where that is not leaves alone"},
           {"fruit_zone_low_m", OFTReal, "lower end of the fruit zone above the ground, m"},
           {"fruit_zone_high_m", OFTReal, "upper end of the fruit zone above the ground, m"},
           {"wood_from", OFTString, kWoodFromDescription}}};
}

Table panel_value_table() {
  Table table{"panel_value", "Canopy of each panel on each date", wkbNone, {kPanelUid, kScanId, kScanDate}};
  add_measured_columns(table);
  return table;
}

Table panel_profile_table() {
  return {"panel_profile",
          "Vertical profile of each panel on each date",
          wkbNone,
          {kPanelUid,
           kScanId,
           kScanDate,
           {"height_low_m", OFTReal, "lower end of the band above the ground, m"},
           {"height_high_m", OFTReal, "upper end of the band above the ground, m"},
           {"plant_area_m2", OFTReal, "plant area in the band, m²; the bands of a panel add up to its plant_area_m2"},
           {"leaf_area_m2", OFTReal, "leaf area in the band, m²; the bands of a panel add up to its leaf_area_m2"}}};
}

Table row_metre_table() {
  Table table{
      "row_metre",
      "Canopy of each half metre of row on each date",
      wkbPoint,
      {kRowNumber,
       {"chainage_m", OFTReal, "centre of the half metre along the row's centreline, m"},
       kScanId,
       kScanDate,
       {"leaf_area_per_m", OFTReal, kLeafAreaPerMDescription},
       {"plant_area_per_m", OFTReal, "one-sided plant area (leaves, wood, posts, wires) per metre of row, m²/m"},
       {"canopy_height_m", OFTReal, "height of the canopy above the ground, m; 0: a gap"},
       {"canopy_width_m", OFTReal, "width of the canopy across the row, m; 0: a gap"}}};
  add_descriptors(table);
  return table;
}

Table panel_wide_table(const BlockProducts& block) {
  Table table{"panel_wide",
              "Leaf area per metre of row of each panel, one column per date",
              wkbPolygon,
              {kPanelUid, kRowNumber, kPanelNumber, kPanelLength}};
  for (std::size_t i = 0; i < block.scans.size(); ++i) {
    table.columns.push_back({wide_column(block, i), OFTReal,
                             "one-sided leaf area per metre of row on " + block.scans[i].scan.scan_date + ", m²/m"});
  }
  return table;
}

Table panel_by_date_view() {
  Table view{"panel_by_date",
             "Panels with their canopy on each date",
             wkbPolygon,
             {kPanelUid, kRowNumber, kPanelNumber, kPanelLength, kScanId, kScanDate}};
  add_measured_columns(view);
  return view;
}

std::string wide_column(const BlockProducts& block, std::size_t index) {
  std::string name = "leaf_area_per_m_" + block.scans[index].scan.scan_date;
  std::replace(name.begin(), name.end(), '-', '_');
  std::size_t earlier = 0;
  for (std::size_t i = 0; i < index; ++i) {
    if (block.scans[i].scan.scan_date == block.scans[index].scan.scan_date) ++earlier;
  }
  return earlier == 0 ? name : name + "_" + std::to_string(earlier + 1);
}

}  // namespace rayfield::formats::gpkg
