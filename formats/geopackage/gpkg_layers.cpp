#include "formats/geopackage/gpkg_layers.h"

#include <cpl_string.h>
#include <ogrsf_frmts.h>

#include <map>

#include "formats/geopackage/gpkg_row.h"
#include "formats/gis/descriptor_columns.h"
#include "formats/gis/measured_columns.h"
#include "rayfield/core/date.h"

namespace rayfield::formats::gpkg {
namespace {

/// The last columns of rows, panels and posts.
template <class Product>
Result<void> put_validity(Row& out, const Product& product) {
  for (const std::string& date : {product.valid_from, product.valid_to})
    if (!date.empty()) RAYFIELD_CHECK(parse_date(date));
  out.text(product.row_name).date(product.valid_from).date(product.valid_to).text(product.source);
  return {};
}

Result<void> fill_block(const OpenGeoPackage& package, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(package, block_table()));
  Row out(*layer);
  out.text(block.block).text(block.farm).text(block.variety);
  return check_written(package, out.write());
}

Result<void> fill_rows(const OpenGeoPackage& package, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(package, vine_row_table()));
  for (const RowProduct& row : block.rows) {
    RAYFIELD_CHECK(check_finite(package, row.centreline, "row " + std::to_string(row.row_number)));
    Row out(*layer);
    out.text(row.row_uid).integer(row.row_number).real(row.length_m).real(row.spacing_m);
    RAYFIELD_CHECK(put_validity(out, row));
    OGRLineString line;
    for (const Eigen::Vector2d& p : row.centreline) line.addPoint(p.x(), p.y());
    if (row.centreline.size() >= 2) out.geometry(line);
    RAYFIELD_CHECK(check_written(package, out.write()));
  }
  return {};
}

Result<void> fill_panels(const OpenGeoPackage& package, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(package, panel_table()));
  for (const PanelProduct& panel : block.panels) {
    Row out(*layer);
    out.text(panel.panel_uid).integer(panel.row_number).integer(panel.panel_number).real(panel.length_m);
    out.real(panel.chainage_start_m).real(panel.chainage_end_m);
    RAYFIELD_CHECK(put_validity(out, panel));
    RAYFIELD_CHECK(set_outline(package, panel, out));
    RAYFIELD_CHECK(check_written(package, out.write()));
  }
  return {};
}

Result<void> fill_posts(const OpenGeoPackage& package, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(package, post_table()));
  for (const PostProduct& post : block.posts) {
    RAYFIELD_CHECK(check_finite(package, {post.position}, "a post of row " + std::to_string(post.row_number)));
    Row out(*layer);
    out.text(post.post_uid).integer(post.row_number).real(post.chainage_m).real(post.ground_m).real(post.height_m);
    out.integer(post.detected ? 1 : 0).geometry(OGRPoint(post.position.x(), post.position.y()));
    RAYFIELD_CHECK(put_validity(out, post));
    RAYFIELD_CHECK(check_written(package, out.write()));
  }
  return {};
}

Result<void> fill_scans(const OpenGeoPackage& package, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(package, scan_table()));
  for (const ScanResults& results : block.scans) {
    const ScanProduct& scan = results.scan;
    RAYFIELD_CHECK(parse_date(scan.scan_date));
    Row out(*layer);
    out.text(scan.scan_id).date(scan.scan_date).text(scan.name).time(scan.start_utc).time(scan.end_utc);
    out.integer(static_cast<std::int64_t>(scan.ray_count));
    out.real(scan.offset_e_m).real(scan.offset_n_m).real(scan.offset_h_m).real(scan.yaw_mrad).real(scan.residual_m);
    out.integer(scan.landmarks).integer(scan.aligned ? 1 : 0);
    out.optional_text(scan.wood_scan_id).optional_text(scan.leaf_note);
    out.real(scan.fruit_zone_low_m).real(scan.fruit_zone_high_m).optional_text(scan.wood_from);
    RAYFIELD_CHECK(check_written(package, out.write()));
  }
  return {};
}

void put_descriptors(Row& out, const CanopyDescriptors& descriptors) {
  for (const DescriptorColumn& column : kDescriptorColumns) out.real(descriptors.*column.value);
}

Result<void> fill_panel_profiles(const OpenGeoPackage& package, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(package, panel_profile_table()));
  for (const ScanResults& results : block.scans) {
    for (const PanelProfileBand& band : results.profile) {
      RAYFIELD_CHECK(parse_date(band.scan_date));
      Row out(*layer);
      out.text(band.panel_uid).text(band.scan_id).date(band.scan_date);
      out.real(band.height_low_m).real(band.height_high_m).real(band.plant_area_m2).real(band.leaf_area_m2);
      RAYFIELD_CHECK(check_written(package, out.write()));
    }
  }
  return {};
}

Result<void> fill_panel_values(const OpenGeoPackage& package, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(package, panel_value_table()));
  for (const ScanResults& results : block.scans) {
    for (const PanelValue& v : results.panel_values) {
      RAYFIELD_CHECK(parse_date(v.scan_date));
      Row out(*layer);
      out.text(v.panel_uid).text(v.scan_id).date(v.scan_date);
      for (const MeasuredColumn& column : kMeasuredColumns) out.real(v.*column.value);
      out.integer(v.ray_count).optional_text(v.wood_scan_id);
      put_descriptors(out, v.descriptors);
      out.optional_text(v.wood_from);
      RAYFIELD_CHECK(check_written(package, out.write()));
    }
  }
  return {};
}

Result<void> fill_row_metres(const OpenGeoPackage& package, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(package, row_metre_table()));
  for (const ScanResults& results : block.scans) {
    for (const RowMetreProduct& metre : results.row_metres) {
      RAYFIELD_CHECK(parse_date(metre.scan_date));
      RAYFIELD_CHECK(
          check_finite(package, {metre.position}, "a half metre of row " + std::to_string(metre.row_number)));
      Row out(*layer);
      out.integer(metre.row_number).real(metre.chainage_m).text(metre.scan_id).date(metre.scan_date);
      out.real(metre.leaf_area_per_m).real(metre.plant_area_per_m);
      out.real(metre.canopy_height_m).real(metre.canopy_width_m);
      put_descriptors(out, metre.descriptors);
      out.geometry(OGRPoint(metre.position.x(), metre.position.y()));
      RAYFIELD_CHECK(check_written(package, out.write()));
    }
  }
  return {};
}

Result<void> fill_panel_wide(const OpenGeoPackage& package, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(package, panel_wide_table(block)));
  std::vector<std::map<std::string, double>> by_scan(block.scans.size());
  for (std::size_t i = 0; i < block.scans.size(); ++i) {
    for (const PanelValue& value : block.scans[i].panel_values) by_scan[i][value.panel_uid] = value.leaf_area_per_m;
  }
  for (const PanelProduct& panel : block.panels) {
    Row out(*layer);
    out.text(panel.panel_uid).integer(panel.row_number).integer(panel.panel_number).real(panel.length_m);
    for (const auto& values : by_scan) {
      const auto found = values.find(panel.panel_uid);
      out.real(found == values.end() ? std::nan("") : found->second);
    }
    RAYFIELD_CHECK(set_outline(package, panel, out));
    RAYFIELD_CHECK(check_written(package, out.write()));
  }
  return {};
}

}  // namespace

Result<OGRLayer*> create_table(const OpenGeoPackage& package, const Table& table, const char* fid) {
  CPLStringList options;
  options.SetNameValue("FID", fid);
  options.SetNameValue("GEOMETRY_NAME", "geom");
  options.SetNameValue("SPATIAL_INDEX", "YES");
  options.SetNameValue("IDENTIFIER", table.name.c_str());
  options.SetNameValue("DESCRIPTION", table.description.c_str());
  OGRSpatialReference* crs = table.geometry == wkbNone ? nullptr : &package.crs;
  OGRLayer* layer = package.dataset.CreateLayer(table.name.c_str(), crs, table.geometry, options.List());
  if (layer == nullptr) return package.gdal.failure(kWhat, package.target);
  for (const Column& column : table.columns) {
    OGRFieldDefn field(column.name.c_str(), column.type);
    const bool key = column.name == table.name + "_uid" || (table.name == "scan" && column.name == "scan_id");
    if (key) {
      field.SetNullable(FALSE);
      field.SetUnique(TRUE);
    }
    if (column.name == "detected" || column.name == "useAsDefault") field.SetSubType(OFSTBoolean);
    if (layer->CreateField(&field) != OGRERR_NONE) return package.gdal.failure(kWhat, package.target);
  }
  return layer;
}

Result<void> fill_tables(const OpenGeoPackage& package, const BlockProducts& block) {
  RAYFIELD_CHECK(fill_rows(package, block));
  RAYFIELD_CHECK(fill_panels(package, block));
  RAYFIELD_CHECK(fill_posts(package, block));
  RAYFIELD_CHECK(fill_scans(package, block));
  RAYFIELD_CHECK(fill_panel_values(package, block));
  RAYFIELD_CHECK(fill_row_metres(package, block));
  RAYFIELD_CHECK(fill_panel_profiles(package, block));
  RAYFIELD_CHECK(fill_panel_wide(package, block));
  return fill_block(package, block);
}

}  // namespace rayfield::formats::gpkg
