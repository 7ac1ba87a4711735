#include "rayfield/formats/registry_file.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "formats/gis/gdal_session.h"
#include "formats/io/guard.h"
#include "formats/io/staged_output.h"
#include "formats/io/text_escape.h"
#include "rayfield/formats/geopackage.h"

namespace rayfield::formats {
namespace {

constexpr std::string_view kWhat = "cannot write the registry";

struct TransformCloser {
  void operator()(OGRCoordinateTransformation* transform) const { OGRCoordinateTransformation::DestroyCT(transform); }
};
using TransformPtr = std::unique_ptr<OGRCoordinateTransformation, TransformCloser>;

std::string json_number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : "null"; }

Result<std::string> json_position(const Eigen::Vector2d& p, OGRCoordinateTransformation& to_wgs84,
                                  const std::string& path) {
  double x = p.x(), y = p.y();
  if (!p.allFinite() || !to_wgs84.Transform(1, &x, &y) || !std::isfinite(x) || !std::isfinite(y))
    return fail(ErrorCode::internal, kWhat, path,
                fmt::format("{:.2f} {:.2f} has no longitude and latitude", p.x(), p.y()));
  return fmt::format("[{:.9f},{:.9f}]", x, y);
}

// The properties that rows and posts share.
template <class Product>
std::string json_properties(const Product& product) {
  return fmt::format("\"row_number\":{},\"row_name\":{},\"valid_from\":{},\"valid_to\":{},\"source\":{}",
                     product.row_number, json_string(product.row_name), json_string(product.valid_from),
                     json_string(product.valid_to), json_string(product.source));
}

// A feature collection in longitude and latitude, as RFC 7946 wants: rows, panels and posts with their identity.
Result<std::string> geojson(const BlockProducts& block, const std::string& path) {
  const GdalSession gdal;
  RAYFIELD_ASSIGN(OGRSpatialReference crs, parse_crs(block.crs, kWhat, path));
  RAYFIELD_ASSIGN(OGRSpatialReference wgs84, parse_crs("EPSG:4326", kWhat, path));
  const TransformPtr to_wgs84(OGRCreateCoordinateTransformation(&crs, &wgs84));
  if (to_wgs84 == nullptr)
    return crs_failure(kWhat, path, "no way from " + block.crs + " to longitude and latitude", "");
  std::string features;
  const auto begin = [&features](const std::string& uid) {
    features += fmt::format("{}\n{{\"type\":\"Feature\",\"id\":{},", features.empty() ? "" : ",", json_string(uid));
  };
  for (const RowProduct& row : block.rows) {
    std::string line;
    for (const Eigen::Vector2d& p : row.centreline) {
      RAYFIELD_ASSIGN(const std::string position, json_position(p, *to_wgs84, path));
      line += (line.empty() ? "" : ",") + position;
    }
    begin(row.row_uid);
    features += fmt::format(
        "\"geometry\":{{\"type\":\"LineString\",\"coordinates\":[{}]}},\"properties\":{{\"kind\":\"row\",\"row_uid\":{}"
        ","
        "{},\"length_m\":{}}}}}",
        line, json_string(row.row_uid), json_properties(row), json_number(row.length_m));
  }
  for (const PostProduct& post : block.posts) {
    RAYFIELD_ASSIGN(const std::string position, json_position(post.position, *to_wgs84, path));
    begin(post.post_uid);
    features += fmt::format(
        "\"geometry\":{{\"type\":\"Point\",\"coordinates\":{}}},\"properties\":{{\"kind\":\"post\",\"post_uid\":{},{},"
        "\"chainage_m\":{},\"height_m\":{},\"detected\":{}}}}}",
        position, json_string(post.post_uid), json_properties(post), json_number(post.chainage_m),
        json_number(post.height_m), post.detected);
  }
  return "{\"type\":\"FeatureCollection\",\"features\":[" + features + "\n]}\n";
}

std::string csv(const BlockProducts& block) {
  std::string text = "kind,uid,row_number,row_name,easting_m,northing_m,height_m,detected,valid_from,valid_to,source\n";
  const auto add = [&text](const char* kind, const std::string& uid, const auto& product, const Eigen::Vector2d& p,
                           const std::string& of_post) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", kind, uid, product.row_number, csv_escape(product.row_name),
                        p.x(), p.y(), of_post, csv_escape(product.valid_from), csv_escape(product.valid_to),
                        csv_escape(product.source));
  };
  for (const RowProduct& row : block.rows)
    for (const Eigen::Vector2d& p : row.centreline) add("row", row.row_uid, row, p, ",");
  for (const PostProduct& post : block.posts) {
    const std::string height = std::isfinite(post.height_m) ? fmt::format("{}", post.height_m) : "";
    add("post", post.post_uid, post, post.position, height + (post.detected ? ",1" : ",0"));
  }
  return text;
}

Result<void> write(const BlockProducts& block, const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".gpkg") return write_geopackage(block, path);
  if (ending == ".csv") return write_file_atomically(path, csv(block), kWhat);
  if (ending != ".geojson" && ending != ".json")
    return fail(ErrorCode::usage, kWhat, path, "unknown kind of file", "give a .gpkg, .geojson or .csv");
  RAYFIELD_ASSIGN(const std::string text, geojson(block, path));
  return write_file_atomically(path, text, kWhat);
}

}  // namespace

Result<void> write_registry_file(const BlockProducts& block, const std::string& path) {
  return guarded(kWhat, path, [&] { return write(block, path); });
}

}  // namespace rayfield::formats
