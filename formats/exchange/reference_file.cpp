#include "rayfield/formats/reference_file.h"

#include <cpl_string.h>
#include <fmt/format.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>

#include "formats/gis/gdal_session.h"
#include "formats/io/guard.h"
#include "formats/io/text_escape.h"

namespace rayfield::formats {
namespace {

constexpr std::string_view kWhat = "cannot read the reference";
constexpr double kLargestBlock = 10e3;  // m; no block is so large, points further apart are in different CRSs
constexpr double kAreaMargin = 0.5;     // degrees around a CRS's area of use, for blocks at its border
constexpr std::size_t kMostPoints = 2000000;

struct TransformCloser {
  void operator()(OGRCoordinateTransformation* transform) const { OGRCoordinateTransformation::DestroyCT(transform); }
};
using TransformPtr = std::unique_ptr<OGRCoordinateTransformation, TransformCloser>;
struct FeatureCloser {
  void operator()(OGRFeature* feature) const { OGRFeature::DestroyFeature(feature); }
};
using FeaturePtr = std::unique_ptr<OGRFeature, FeatureCloser>;

tl::unexpected<Error> refused(const std::string& where, const std::string& why, const std::string& next) {
  return fail(ErrorCode::bad_input, kWhat, where, why, next);
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string ending_of(const std::string& path) { return lower(std::filesystem::path(path).extension().string()); }

std::optional<double> number_of(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// The fields of a feature by their names in lower case.
class Fields {
 public:
  explicit Fields(OGRFeature& feature) {
    for (int i = 0; i < feature.GetFieldCount(); ++i)
      if (feature.IsFieldSetAndNotNull(i))
        values_[lower(feature.GetFieldDefnRef(i)->GetNameRef())] = feature.GetFieldAsString(i);
  }
  /// The first of `names` that has a value; empty if none has.
  std::string text(std::initializer_list<const char*> names) const {
    for (const char* name : names)
      if (const auto it = values_.find(name); it != values_.end() && !it->second.empty()) return clean_text(it->second);
    return {};
  }
  std::optional<double> number(std::initializer_list<const char*> names) const { return number_of(text(names)); }

 private:
  std::map<std::string, std::string> values_;
};

// A row's number and name. Anything in `row` that is not a whole number is a name.
struct RowLabel {
  std::optional<int> number;
  std::string name;
};

RowLabel label_of(const Fields& fields, bool name_is_row_name) {
  RowLabel label;
  const std::string row = fields.text({"row_number", "row_no", "row"});
  const std::optional<double> number = number_of(row);
  if (number && std::floor(*number) == *number && std::abs(*number) < 1e9) {
    label.number = static_cast<int>(*number);
  } else {
    label.name = row;
  }
  const std::string name = name_is_row_name ? fields.text({"row_name", "name"}) : fields.text({"row_name"});
  if (!name.empty()) label.name = name;
  return label;
}

SurveyedPost post_of(const Fields& fields, const Eigen::Vector2d& position) {
  const RowLabel label = label_of(fields, false);
  SurveyedPost post{label.number, label.name, position, {}, {}};
  if (const auto height = fields.number({"height_m"}); height && *height > 0.3 && *height < 6) post.height_m = height;
  if (const auto diameter = fields.number({"diameter_m"}); diameter && *diameter > 0.01 && *diameter < 0.5)
    post.diameter_m = diameter;
  return post;
}

// Takes points of one layer to the store's CRS.
class Reprojection {
 public:
  static Result<Reprojection> create(const OGRSpatialReference* from, const OGRSpatialReference& to,
                                     const std::string& where) {
    // GeoPackages name what they do not know: "Undefined geographic SRS", "Undefined Cartesian SRS".
    const std::string name = from == nullptr || from->GetName() == nullptr ? "" : lower(from->GetName());
    if ((name.empty() || name.rfind("undefined", 0) == 0) || (!from->IsProjected() && !from->IsGeographic()))
      return refused(where, "it does not say in which coordinate reference system it is",
                     "assign the layer's CRS, for example in QGIS, and save it again");
    OGRSpatialReference source(*from), target(to);
    source.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    Reprojection made(TransformPtr(OGRCreateCoordinateTransformation(&source, &target)), where);
    if (made.transform_ == nullptr)
      return refused(where, fmt::format("there is no way from {} to the store's CRS", source.GetName()),
                     "save it in another CRS");
    return made;
  }
  Result<Eigen::Vector2d> operator()(double x, double y) const {
    double east = x, north = y;
    if (!std::isfinite(x) || !std::isfinite(y) || !transform_->Transform(1, &east, &north) || !std::isfinite(east) ||
        !std::isfinite(north))
      return refused(where_, fmt::format("the point {} {} has no place in the store's CRS", x, y),
                     "check the CRS that the file or layer claims to be in");
    return Eigen::Vector2d(east, north);
  }

 private:
  Reprojection(TransformPtr transform, std::string where)
      : transform_(std::move(transform)), where_(std::move(where)) {}
  TransformPtr transform_;
  std::string where_;
};

Result<std::vector<Eigen::Vector2d>> vertices(const OGRLineString& line, const Reprojection& to_map) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < line.getNumPoints(); ++i) {
    RAYFIELD_ASSIGN(const Eigen::Vector2d p, to_map(line.getX(i), line.getY(i)));
    points.push_back(p);
  }
  return points;
}

// Lines and points of a geometry, collections taken apart.
Result<void> take(const OGRGeometry& geometry, const Fields& fields, const Reprojection& to_map, SurveyedBlock& out) {
  switch (wkbFlatten(geometry.getGeometryType())) {
    case wkbLineString: {
      const RowLabel label = label_of(fields, true);
      RAYFIELD_ASSIGN(std::vector<Eigen::Vector2d> line, vertices(*geometry.toLineString(), to_map));
      out.rows.push_back({label.number, label.name, std::move(line)});
      return {};
    }
    case wkbPoint: {
      if (geometry.IsEmpty()) return {};
      RAYFIELD_ASSIGN(const Eigen::Vector2d p, to_map(geometry.toPoint()->getX(), geometry.toPoint()->getY()));
      out.posts.push_back(post_of(fields, p));
      return {};
    }
    case wkbMultiLineString:
    case wkbMultiPoint:
    case wkbGeometryCollection:
      for (const OGRGeometry* part : *geometry.toGeometryCollection()) RAYFIELD_CHECK(take(*part, fields, to_map, out));
      return {};
    default:
      return {};
  }
}

std::size_t point_count(const SurveyedBlock& block) {
  std::size_t points = block.posts.size();
  for (const SurveyedRow& row : block.rows) points += row.line.size();
  return points;
}

Result<void> take_layer(OGRLayer& layer, const OGRSpatialReference& crs, const std::string& where, SurveyedBlock& out) {
  RAYFIELD_ASSIGN(const Reprojection to_map, Reprojection::create(layer.GetSpatialRef(), crs, where));
  layer.ResetReading();
  while (const FeaturePtr feature{layer.GetNextFeature()}) {
    const Fields fields(*feature);
    // Whatever our own exports mark as gone is not a reference any more.
    if (!fields.text({"valid_to"}).empty()) continue;
    if (const OGRGeometry* geometry = feature->GetGeometryRef()) RAYFIELD_CHECK(take(*geometry, fields, to_map, out));
    if (point_count(out) > kMostPoints)
      return refused(where, fmt::format("it has more than {} points", kMostPoints), "give rows and posts only");
  }
  return {};
}

// Our own GeoPackages hold more points and lines than rows and posts: of those, only these two.
Result<void> take_vector_file(GDALDataset& dataset, const OGRSpatialReference& crs, const std::string& path,
                              SurveyedBlock& out) {
  const bool ours = dataset.GetLayerByName("vine_row") != nullptr;
  for (OGRLayer* layer : dataset.GetLayers()) {
    const std::string name = layer->GetName();
    if (ours && name != "vine_row" && name != "post") continue;
    if (layer->GetGeomType() == wkbNone) continue;
    RAYFIELD_CHECK(take_layer(*layer, crs, fmt::format("{} layer {}", path, name), out));
  }
  return {};
}

// One post per line, or with `kind` "row" one vertex of a row's line.
Result<void> take_csv(GDALDataset& dataset, const OGRSpatialReference& crs, const std::string& path,
                      SurveyedBlock& out) {
  RAYFIELD_ASSIGN(OGRSpatialReference wgs84, parse_crs("EPSG:4326", kWhat, path));
  RAYFIELD_ASSIGN(const Reprojection from_degrees, Reprojection::create(&wgs84, crs, path));
  OGRLayer* layer = dataset.GetLayer(0);
  int line = 1;
  while (const FeaturePtr feature{layer == nullptr ? nullptr : layer->GetNextFeature()}) {
    const std::string where = fmt::format("{} line {}", path, ++line);
    const Fields fields(*feature);
    if (!fields.text({"valid_to"}).empty()) continue;
    const auto lon = fields.number({"longitude", "lon"}), lat = fields.number({"latitude", "lat"});
    const auto east = fields.number({"easting_m", "easting", "x"}),
               north = fields.number({"northing_m", "northing", "y"});
    if (!(lon && lat) && !(east && north))
      return refused(where, "it has no coordinates",
                     "give columns longitude and latitude (WGS 84), or easting and northing in the store's CRS");
    Eigen::Vector2d p(east.value_or(0), north.value_or(0));
    if (!(east && north)) {
      RAYFIELD_ASSIGN(p, from_degrees(*lon, *lat));
    }
    if (lower(fields.text({"kind"})) != "row") {
      out.posts.push_back(post_of(fields, p));
      continue;
    }
    const RowLabel label = label_of(fields, true);
    const bool goes_on =
        !out.rows.empty() && out.rows.back().number == label.number && out.rows.back().name == label.name;
    if (!goes_on) out.rows.push_back({label.number, label.name, {}});
    out.rows.back().line.push_back(p);
  }
  return {};
}

std::vector<Eigen::Vector2d> all_points(const SurveyedBlock& block) {
  std::vector<Eigen::Vector2d> points;
  for (const SurveyedRow& row : block.rows) points.insert(points.end(), row.line.begin(), row.line.end());
  for (const SurveyedPost& post : block.posts) points.push_back(post.position);
  return points;
}

// Mistaken CRSs show in where things come to lie: outside of where the store's CRS is used, or far from each other.
Result<void> check_places(const SurveyedBlock& block, const OGRSpatialReference& crs, const std::string& code,
                          const std::string& path) {
  const std::vector<Eigen::Vector2d> points = all_points(block);
  RAYFIELD_ASSIGN(OGRSpatialReference wgs84, parse_crs("EPSG:4326", kWhat, path));
  OGRSpatialReference map(crs);
  const TransformPtr to_degrees(OGRCreateCoordinateTransformation(&map, &wgs84));
  double west = 0, south = 0, east = 0, north = 0;
  const bool bounded = crs.GetAreaOfUse(&west, &south, &east, &north, nullptr) && west > -1000 && west <= east;
  for (const Eigen::Vector2d& p : points) {
    if (!bounded || to_degrees == nullptr) break;
    double lon = p.x(), lat = p.y();
    const bool placed = to_degrees->Transform(1, &lon, &lat) && std::isfinite(lon) && std::isfinite(lat);
    if (placed && lon > west - kAreaMargin && lon < east + kAreaMargin && lat > south - kAreaMargin &&
        lat < north + kAreaMargin)
      continue;
    return refused(path,
                   fmt::format("a point comes to lie at longitude {:.3f}, latitude {:.3f}, but the store's {} is for "
                               "{:.1f} to {:.1f}, {:.1f} to {:.1f}",
                               lon, lat, code, west, east, south, north),
                   "check the CRS of the file, the order of its coordinates, and the store's CRS");
  }
  for (const Eigen::Vector2d& p : points) {
    const double apart = (p - points.front()).norm();
    if (apart <= kLargestBlock) continue;
    return refused(path,
                   fmt::format("its points lie {:.0f} km apart ({:.0f} {:.0f} and {:.0f} {:.0f}), further than a block",
                               apart / 1000, points.front().x(), points.front().y(), p.x(), p.y()),
                   "give the rows and posts of one block, and check their coordinates");
  }
  return {};
}

Result<SurveyedBlock> read(const std::string& path, const std::string& code) {
  static const std::map<std::string, const char*> kDrivers = {
      {".gpkg", "GPKG"}, {".geojson", "GeoJSON"}, {".json", "GeoJSON"}, {".csv", "CSV"}};
  const auto driver = kDrivers.find(ending_of(path));
  if (driver == kDrivers.end())
    return fail(ErrorCode::usage, kWhat, path, "unknown kind of file", "give a .gpkg, .geojson or .csv");
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return refused(path, "there is no such file", "check the path");
  const GdalSession gdal;
  RAYFIELD_ASSIGN(const OGRSpatialReference crs, parse_crs(code, kWhat, path));
  const char* allowed[] = {driver->second, nullptr};
  const DatasetPtr dataset(
      GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, allowed));
  if (dataset == nullptr)
    return refused(path, fmt::format("it is not a readable {}", driver->second), "check the file, or save it again");
  SurveyedBlock block;
  block.source = path;
  if (std::string_view(driver->second) == "CSV") {
    RAYFIELD_CHECK(take_csv(*dataset, crs, path, block));
  } else {
    RAYFIELD_CHECK(take_vector_file(*dataset, crs, path, block));
  }
  if (gdal.failed()) return refused(path, "it cannot be read to its end", "check the file, or save it again");
  if (point_count(block) == 0)
    return refused(path, "it holds neither lines nor points", "give rows as lines or posts as points");
  RAYFIELD_CHECK(check_places(block, crs, code, path));
  return block;
}

}  // namespace

Result<SurveyedBlock> read_reference_file(const std::string& path, const std::string& crs) {
  return guarded(kWhat, path, [&] { return read(path, crs); });
}

}  // namespace rayfield::formats
