#include "formats/gis/vector_file.h"

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <fmt/format.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "formats/io/text_escape.h"
#include "rayfield/core/date.h"

namespace rayfield::formats {
namespace {

/// Widest text of a DBF file, bytes.
constexpr std::size_t kWidestText = 254;

/// A folder of GDAL's in memory.
class MemoryFolder {
 public:
  MemoryFolder() {
    static std::atomic<std::uint64_t> number = 0;
    path_ = fmt::format("/vsimem/rayfield-{}", ++number);
    VSIMkdir(path_.c_str(), 0700);
  }
  ~MemoryFolder() { VSIRmdirRecursive(path_.c_str()); }
  MemoryFolder(const MemoryFolder&) = delete;
  MemoryFolder& operator=(const MemoryFolder&) = delete;

  std::string path(const std::string& name) const { return path_ + "/" + name; }
  /// All files, by name.
  std::vector<NamedBytes> files() const {
    std::vector<NamedBytes> all;
    const CPLStringList names(VSIReadDir(path_.c_str()), TRUE);
    for (int i = 0; i < names.size(); ++i) {
      vsi_l_offset size = 0;
      const GByte* bytes = VSIGetMemFileBuffer(path(names[i]).c_str(), &size, FALSE);
      if (bytes != nullptr) all.push_back({names[i], {reinterpret_cast<const char*>(bytes), size}});
    }
    std::sort(all.begin(), all.end(), [](const NamedBytes& a, const NamedBytes& b) { return a.name < b.name; });
    return all;
  }

 private:
  std::string path_;
};

/// Text that fits a DBF file, cut between characters.
std::string short_text(std::string text) {
  if (text.size() <= kWidestText) return text;
  std::size_t end = kWidestText;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return text.substr(0, end);
}

struct Writer {
  const VectorTable& table;
  const VectorFormat& format;
  const GdalSession& gdal;
  std::string_view what, where;
  bool short_names() const { return std::string_view(format.driver) == "ESRI Shapefile"; }
  tl::unexpected<Error> failure() const { return gdal.failure(what, where); }
};

/// As wide as its widest value: DBF files store every text at full width.
int text_width(const Writer& w, std::size_t column) {
  std::size_t width = 1;
  for (const VectorFeature& feature : w.table.features) {
    if (column >= feature.values.size()) continue;
    if (const auto* text = std::get_if<std::string>(&feature.values[column]))
      width = std::max(width, clean_text(*text).size());
  }
  return static_cast<int>(std::min(width, kWidestText));
}

bool create_columns(const Writer& w, OGRLayer& layer) {
  for (std::size_t i = 0; i < w.table.columns.size(); ++i) {
    const VectorColumn& column = w.table.columns[i];
    const bool text = w.format.values_as_json || (column.type == OFTDate && w.format.dates_as_text);
    OGRFieldDefn field((w.short_names() ? column.short_name : column.name).c_str(), text ? OFTString : column.type);
    if (w.format.values_as_json) field.SetSubType(OFSTJSON);
    if (w.short_names() && column.type == OFTString) field.SetWidth(text_width(w, i));
    // Six decimals and eleven digits before them: a micrometre, and no number as wide as many readers refuse.
    if (w.short_names() && column.type == OFTReal) field.SetWidth(18), field.SetPrecision(6);
    if (layer.CreateField(&field) != OGRERR_NONE) return false;
  }
  for (const std::string& extra : {w.format.id_column.empty() ? std::string() : "id", w.format.name_field}) {
    OGRFieldDefn field(extra.c_str(), OFTString);
    if (!extra.empty() && layer.CreateField(&field) != OGRERR_NONE) return false;
  }
  return true;
}

void set_date(const std::string& date, int field, OGRFeature& out) {
  const auto day = parse_calendar_day(date);
  if (!day) return out.SetFieldNull(field);
  out.SetField(field, static_cast<int>(day->year()), static_cast<int>(static_cast<unsigned>(day->month())),
               static_cast<int>(static_cast<unsigned>(day->day())));
}

std::string json_value(const VectorValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return json_string(*text);
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
  if (const auto* real = std::get_if<double>(&value)) return number_text(*real, "");
  return {};
}

void set_value(const Writer& w, const VectorColumn& column, const VectorValue& value, int field, OGRFeature& out) {
  if (w.format.values_as_json) {
    const std::string json = json_value(value);
    return json.empty() ? out.SetFieldNull(field) : out.SetField(field, json.c_str());
  }
  if (const auto* text = std::get_if<std::string>(&value)) {
    if (column.type == OFTDate && !w.format.dates_as_text) return set_date(*text, field, out);
    out.SetField(field, (w.short_names() ? short_text(clean_text(*text)) : clean_text(*text)).c_str());
  } else if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    out.SetField(field, static_cast<GIntBig>(*integer));
  } else if (const auto* real = std::get_if<double>(&value); real != nullptr && std::isfinite(*real)) {
    out.SetField(field, *real);
  } else {
    out.SetFieldNull(field);
  }
}

bool write_features(const Writer& w, OGRLayer& layer) {
  for (const VectorFeature& feature : w.table.features) {
    const std::unique_ptr<OGRFeature> out(OGRFeature::CreateFeature(layer.GetLayerDefn()));
    for (std::size_t i = 0; i < std::min(feature.values.size(), w.table.columns.size()); ++i) {
      const VectorColumn& column = w.table.columns[i];
      set_value(w, column, feature.values[i], static_cast<int>(i), *out);
      if (column.name != w.format.id_column) continue;
      if (const auto* id = std::get_if<std::string>(&feature.values[i])) out->SetField("id", clean_text(*id).c_str());
    }
    if (!w.format.name_field.empty()) out->SetField(w.format.name_field.c_str(), clean_text(feature.label).c_str());
    if (!w.format.fill_opacity.empty() && !feature.fill.empty())
      out->SetStyleString(
          fmt::format("BRUSH(fc:{}{});PEN(c:#404040,w:1px)", feature.fill, w.format.fill_opacity).c_str());
    if (feature.geometry != nullptr && !feature.geometry->IsEmpty()) out->SetGeometry(feature.geometry.get());
    if (layer.CreateFeature(out.get()) != OGRERR_NONE) return false;
  }
  return true;
}

Result<void> write_into(const Writer& w, const std::string& path, const std::string& stem) {
  RAYFIELD_ASSIGN(OGRSpatialReference wgs84, parse_crs("EPSG:4326", w.what, w.where));
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(w.format.driver);
  DatasetPtr dataset(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  if (dataset == nullptr) return w.failure();
  CPLStringList options;
  for (const std::string& option : w.format.layer_options) options.AddString(option.c_str());
  OGRLayer* layer = dataset->CreateLayer(stem.c_str(), &wgs84, w.table.geometry, options.List());
  if (layer == nullptr || !create_columns(w, *layer) || !write_features(w, *layer)) return w.failure();
  dataset.reset();
  if (w.gdal.failed()) return w.failure();
  return {};
}

Result<void> check_written(const Writer& w, const std::string& path) {
  const DatasetPtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_VERBOSE_ERROR));
  if (dataset == nullptr || dataset->GetLayerCount() != 1) return w.failure();
  const auto expected = std::count_if(w.table.features.begin(), w.table.features.end(), [&](const VectorFeature& f) {
    return !w.format.places_only || (f.geometry != nullptr && !f.geometry->IsEmpty());
  });
  if (dataset->GetLayer(0)->GetFeatureCount() == expected) return {};
  return fail(ErrorCode::internal, w.what, w.where, "the file reads back other features than were written");
}

}  // namespace

VectorFormat geojson_format(std::uint64_t snapshot, const std::string& id_column) {
  // A member of our own beside RFC 7946's, which its section 6.1 allows.
  std::vector<std::string> options = {
      "RFC7946=YES", "COORDINATE_PRECISION=9", "WRITE_NAME=NO",
      fmt::format("NATIVE_DATA={{\"type\":\"FeatureCollection\",\"snapshot\":{}}}", snapshot),
      "NATIVE_MEDIA_TYPE=application/vnd.geo+json"};
  if (!id_column.empty()) options.insert(options.end(), {"ID_FIELD=id", "ID_TYPE=String"});
  return {"GeoJSON", ".geojson", std::move(options), true, true, false, id_column};
}

VectorFormat kml_format() { return {"LIBKML", ".kml", {}, true, false, false, {}, "Name", "B0"}; }

VectorFormat flatgeobuf_format() { return {"FlatGeobuf", ".fgb", {"SPATIAL_INDEX=YES"}, false, false, true}; }

VectorFormat geoparquet_format() { return {"Parquet", ".parquet", {"GEOMETRY_ENCODING=WKB"}}; }

VectorFormat shapefile_format(const std::string& date) {
  return {"ESRI Shapefile", ".shp", {"ENCODING=UTF-8", "DBF_DATE_LAST_UPDATE=" + date}};
}

Result<void> check_driver(const VectorFormat& format, std::string_view what, std::string_view where) {
  const GdalSession gdal;
  if (GetGDALDriverManager()->GetDriverByName(format.driver) != nullptr) return {};
  return fail(ErrorCode::usage, what, where, fmt::format("this GDAL has no driver {}", format.driver),
              "choose another --format, or use a GDAL that is built with it");
}

Result<std::vector<NamedBytes>> vector_files(const VectorTable& table, const VectorFormat& format,
                                             const std::string& stem, std::string_view what, std::string_view where) {
  RAYFIELD_CHECK(check_driver(format, what, where));
  const GdalSession gdal;
  const MemoryFolder folder;
  const Writer writer{table, format, gdal, what, where};
  const std::string path = folder.path(stem + format.extension);
  RAYFIELD_CHECK(write_into(writer, path, stem));
  RAYFIELD_CHECK(check_written(writer, path));
  return folder.files();
}

}  // namespace rayfield::formats
