#include "formats/gis/gpkg_layers.h"

#include <cpl_string.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <cstdlib>
#include <map>

#include "formats/io/text_escape.h"
#include "rayfield/core/date.h"

namespace rayfield::formats::gpkg {
namespace {

/// One row of a table, filled column by column in the order of its description.
class Row {
 public:
  explicit Row(OGRLayer& layer) : layer_(layer), feature_(OGRFeature::CreateFeature(layer.GetLayerDefn())) {}
  ~Row() { OGRFeature::DestroyFeature(feature_); }
  Row(const Row&) = delete;
  Row& operator=(const Row&) = delete;

  Row& text(const std::string& value) {
    feature_->SetField(column_++, clean_text(value).c_str());
    return *this;
  }
  Row& integer(std::int64_t value) {
    feature_->SetField(column_++, static_cast<GIntBig>(value));
    return *this;
  }
  /// NaN (not scanned, undefined) and infinities become NULL.
  Row& real(double value) {
    if (std::isfinite(value)) {
      feature_->SetField(column_++, value);
    } else {
      feature_->SetFieldNull(column_++);
    }
    return *this;
  }
  /// `date`: YYYY-MM-DD, already checked.
  Row& date(const std::string& date) {
    feature_->SetField(column_++, std::atoi(date.substr(0, 4).c_str()), std::atoi(date.substr(5, 2).c_str()),
                       std::atoi(date.substr(8, 2).c_str()));
    return *this;
  }
  /// ISO 8601 UTC; anything else becomes NULL.
  Row& time(const std::string& utc) {
    OGRField value;
    if (OGRParseDate(utc.c_str(), &value, 0)) {
      value.Date.TZFlag = 100;
      feature_->SetField(column_++, &value);
    } else {
      feature_->SetFieldNull(column_++);
    }
    return *this;
  }
  Row& geometry(const OGRGeometry& geometry) {
    feature_->SetGeometry(&geometry);
    return *this;
  }
  bool write() { return layer_.CreateFeature(feature_) == OGRERR_NONE; }

 private:
  OGRLayer& layer_;
  OGRFeature* feature_;
  int column_ = 0;
};

Result<void> check_finite(const Filling& filling, const std::vector<Eigen::Vector2d>& points, const std::string& of) {
  for (const Eigen::Vector2d& p : points) {
    if (!p.allFinite())
      return fail(ErrorCode::internal, what, filling.target, of + " has a coordinate that is not finite");
  }
  return {};
}

Result<void> check_written(const Filling& filling, bool written) {
  if (written && !filling.gdal.failed()) return {};
  return filling.gdal.failure(what, filling.target);
}

Result<void> fill_rows(const Filling& filling, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(filling, vine_row_table()));
  for (const RowProduct& row : block.rows) {
    RAYFIELD_CHECK(check_finite(filling, row.centreline, "row " + std::to_string(row.row_number)));
    Row out(*layer);
    out.text(row.row_uid).integer(row.row_number).real(row.length_m).real(row.spacing_m);
    OGRLineString line;
    for (const Eigen::Vector2d& p : row.centreline) line.addPoint(p.x(), p.y());
    if (row.centreline.size() >= 2) out.geometry(line);
    RAYFIELD_CHECK(check_written(filling, out.write()));
  }
  return {};
}

/// The panel's outline as a polygon; an outline of fewer than three corners gives none.
Result<void> set_outline(const Filling& filling, const PanelProduct& panel, Row& out) {
  const std::string of = "panel " + std::to_string(panel.row_number) + "/" + std::to_string(panel.panel_number);
  RAYFIELD_CHECK(check_finite(filling, panel.outline, of));
  if (panel.outline.size() < 3) return {};
  OGRLinearRing ring;
  for (const Eigen::Vector2d& p : panel.outline) ring.addPoint(p.x(), p.y());
  ring.closeRings();
  OGRPolygon polygon;
  polygon.addRing(&ring);
  out.geometry(polygon);
  return {};
}

Result<void> fill_panels(const Filling& filling, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(filling, panel_table()));
  for (const PanelProduct& panel : block.panels) {
    Row out(*layer);
    out.text(panel.panel_uid).integer(panel.row_number).integer(panel.panel_number).real(panel.length_m);
    out.real(panel.chainage_start_m).real(panel.chainage_end_m);
    RAYFIELD_CHECK(set_outline(filling, panel, out));
    RAYFIELD_CHECK(check_written(filling, out.write()));
  }
  return {};
}

Result<void> fill_posts(const Filling& filling, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(filling, post_table()));
  for (const PostProduct& post : block.posts) {
    RAYFIELD_CHECK(check_finite(filling, {post.position}, "a post of row " + std::to_string(post.row_number)));
    Row out(*layer);
    out.text(post.post_uid).integer(post.row_number).real(post.chainage_m).real(post.ground_m).real(post.height_m);
    out.integer(post.detected ? 1 : 0).geometry(OGRPoint(post.position.x(), post.position.y()));
    RAYFIELD_CHECK(check_written(filling, out.write()));
  }
  return {};
}

Result<void> fill_scans(const Filling& filling, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(filling, scan_table()));
  for (const ScanResults& results : block.scans) {
    const ScanProduct& scan = results.scan;
    RAYFIELD_CHECK(parse_date(scan.scan_date));
    Row out(*layer);
    out.text(scan.scan_id).date(scan.scan_date).text(scan.name).time(scan.start_utc).time(scan.end_utc);
    out.integer(static_cast<std::int64_t>(scan.ray_count));
    RAYFIELD_CHECK(check_written(filling, out.write()));
  }
  return {};
}

Result<void> fill_panel_values(const Filling& filling, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(filling, panel_value_table()));
  for (const ScanResults& results : block.scans) {
    for (const PanelValue& v : results.panel_values) {
      RAYFIELD_CHECK(parse_date(v.scan_date));
      Row out(*layer);
      out.text(v.panel_uid).text(v.scan_id).date(v.scan_date);
      out.real(v.plant_area_m2).real(v.leaf_area_m2).real(v.leaf_area_per_m).real(v.lai);
      out.real(v.se_leaf_area_m2).real(v.ci_low_m2).real(v.ci_high_m2);
      out.real(v.canopy_height_m).real(v.canopy_width_m).real(v.gap_fraction).real(v.observed_fraction);
      out.integer(v.ray_count);
      RAYFIELD_CHECK(check_written(filling, out.write()));
    }
  }
  return {};
}

Result<void> fill_row_metres(const Filling& filling, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(filling, row_metre_table()));
  for (const ScanResults& results : block.scans) {
    for (const RowMetreProduct& metre : results.row_metres) {
      RAYFIELD_CHECK(parse_date(metre.scan_date));
      RAYFIELD_CHECK(
          check_finite(filling, {metre.position}, "a half metre of row " + std::to_string(metre.row_number)));
      Row out(*layer);
      out.integer(metre.row_number).real(metre.chainage_m).text(metre.scan_id).date(metre.scan_date);
      out.real(metre.leaf_area_per_m).real(metre.plant_area_per_m);
      out.geometry(OGRPoint(metre.position.x(), metre.position.y()));
      RAYFIELD_CHECK(check_written(filling, out.write()));
    }
  }
  return {};
}

Result<void> fill_panel_wide(const Filling& filling, const BlockProducts& block) {
  RAYFIELD_ASSIGN(OGRLayer * layer, create_table(filling, panel_wide_table(block)));
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
    RAYFIELD_CHECK(set_outline(filling, panel, out));
    RAYFIELD_CHECK(check_written(filling, out.write()));
  }
  return {};
}

}  // namespace

Result<OGRLayer*> create_table(const Filling& filling, const Table& table, const char* fid) {
  CPLStringList options;
  options.SetNameValue("FID", fid);
  options.SetNameValue("GEOMETRY_NAME", "geom");
  options.SetNameValue("SPATIAL_INDEX", "YES");
  options.SetNameValue("IDENTIFIER", table.name.c_str());
  options.SetNameValue("DESCRIPTION", table.description.c_str());
  OGRSpatialReference* crs = table.geometry == wkbNone ? nullptr : &filling.crs;
  OGRLayer* layer = filling.dataset.CreateLayer(table.name.c_str(), crs, table.geometry, options.List());
  if (layer == nullptr) return filling.gdal.failure(what, filling.target);
  for (const Column& column : table.columns) {
    OGRFieldDefn field(column.name.c_str(), column.type);
    const bool key = column.name == table.name + "_uid" || (table.name == "scan" && column.name == "scan_id");
    if (key) {
      field.SetNullable(FALSE);
      field.SetUnique(TRUE);
    }
    if (column.name == "detected" || column.name == "useAsDefault") field.SetSubType(OFSTBoolean);
    if (layer->CreateField(&field) != OGRERR_NONE) return filling.gdal.failure(what, filling.target);
  }
  return layer;
}

Result<void> fill_tables(const Filling& filling, const BlockProducts& block) {
  RAYFIELD_CHECK(fill_rows(filling, block));
  RAYFIELD_CHECK(fill_panels(filling, block));
  RAYFIELD_CHECK(fill_posts(filling, block));
  RAYFIELD_CHECK(fill_scans(filling, block));
  RAYFIELD_CHECK(fill_panel_values(filling, block));
  RAYFIELD_CHECK(fill_row_metres(filling, block));
  return fill_panel_wide(filling, block);
}

}  // namespace rayfield::formats::gpkg
