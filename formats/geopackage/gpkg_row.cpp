#include "formats/geopackage/gpkg_row.h"

#include <cmath>

#include "formats/io/text_escape.h"
#include "rayfield/core/date.h"

namespace rayfield::formats::gpkg {

Row::Row(OGRLayer& layer) : layer_(layer), feature_(OGRFeature::CreateFeature(layer.GetLayerDefn())) {}
Row::~Row() { OGRFeature::DestroyFeature(feature_); }

Row& Row::text(const std::string& value) {
  feature_->SetField(column_++, clean_text(value).c_str());
  return *this;
}

Row& Row::optional_text(const std::string& value) {
  if (!value.empty()) return text(value);
  feature_->SetFieldNull(column_++);
  return *this;
}

Row& Row::integer(std::int64_t value) {
  feature_->SetField(column_++, static_cast<GIntBig>(value));
  return *this;
}

Row& Row::real(double value) {
  if (std::isfinite(value)) {
    feature_->SetField(column_++, value);
  } else {
    feature_->SetFieldNull(column_++);
  }
  return *this;
}

Row& Row::date(const std::string& date) {
  if (const auto day = parse_calendar_day(date)) {
    feature_->SetField(column_++, static_cast<int>(day->year()), static_cast<int>(static_cast<unsigned>(day->month())),
                       static_cast<int>(static_cast<unsigned>(day->day())));
  } else {
    feature_->SetFieldNull(column_++);
  }
  return *this;
}

Row& Row::time(const std::string& utc) {
  OGRField value;
  if (OGRParseDate(utc.c_str(), &value, 0)) {
    value.Date.TZFlag = 100;
    feature_->SetField(column_++, &value);
  } else {
    feature_->SetFieldNull(column_++);
  }
  return *this;
}

Row& Row::geometry(const OGRGeometry& geometry) {
  feature_->SetGeometry(&geometry);
  return *this;
}

bool Row::write() { return layer_.CreateFeature(feature_) == OGRERR_NONE; }

Result<void> check_finite(const OpenGeoPackage& package, const std::vector<Eigen::Vector2d>& points,
                          const std::string& of) {
  for (const Eigen::Vector2d& p : points) {
    if (!p.allFinite())
      return fail(ErrorCode::internal, kWhat, package.target, of + " has a coordinate that is not finite");
  }
  return {};
}

Result<void> check_written(const OpenGeoPackage& package, bool written) {
  if (written && !package.gdal.failed()) return {};
  return package.gdal.failure(kWhat, package.target);
}

Result<void> set_outline(const OpenGeoPackage& package, const PanelProduct& panel, Row& out) {
  const std::string of = "panel " + std::to_string(panel.row_number) + "/" + std::to_string(panel.panel_number);
  RAYFIELD_CHECK(check_finite(package, panel.outline, of));
  if (panel.outline.size() < 3) return {};
  OGRLinearRing ring;
  for (const Eigen::Vector2d& p : panel.outline) ring.addPoint(p.x(), p.y());
  ring.closeRings();
  OGRPolygon polygon;
  polygon.addRing(&ring);
  out.geometry(polygon);
  return {};
}

}  // namespace rayfield::formats::gpkg
