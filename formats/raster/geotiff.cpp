#include "rayfield/formats/geotiff.h"

#include <cpl_string.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <span>
#include <string>

#include "formats/gis/gdal_session.h"
#include "formats/gis/qml.h"
#include "formats/io/guard.h"
#include "formats/io/staged_output.h"
#include "formats/io/text_escape.h"
#include "formats/raster/raster_statistics.h"
#include "rayfield/core/file.h"
#include "rayfield/core/sha256.h"

namespace rayfield::formats {
namespace {

constexpr std::string_view kWhat = "cannot write GeoTIFF";

/// One raster on its way to the disk.
struct Job {
  const RasterLayout& layout;
  const RowReader& read;
  const OGRSpatialReference& crs;
  const StagedOutput& staged;
  const GeoTiffOptions& options;
  GdalSession& gdal;
};

Result<void> check_layout(const RasterLayout& layout, const std::string& path) {
  const auto bad = [&path](std::string_view why) { return fail(ErrorCode::internal, kWhat, path, why); };
  if (layout.nx < 1 || layout.ny < 1) return bad("the raster has no cells");
  if (!(layout.cell_m > 0) || !std::isfinite(layout.cell_m) || !layout.origin.allFinite()) {
    return bad("the raster's origin or cell size is not finite");
  }
  return {};
}

/// The bands of rows from the north end, each handed to `use(iy_begin, row_count)`.
template <class Use>
Result<void> for_each_band(const RasterLayout& layout, int rows_per_band, const Use& use) {
  for (int top = layout.ny; top > 0; top -= rows_per_band) {
    const int count = std::min(rows_per_band, top);
    RAYFIELD_CHECK(use(top - count, count));
  }
  return {};
}

/// Moves one band between the file (north-up, first row on top) and memory (rows northwards).
bool transfer(GDALDataset& dataset, GDALRWFlag direction, const RasterLayout& layout, int iy_begin, int count,
              float* values) {
  const GSpacing line = static_cast<GSpacing>(layout.nx) * static_cast<GSpacing>(sizeof(float));
  float* north_row = values + static_cast<std::size_t>(count - 1) * static_cast<std::size_t>(layout.nx);
  return dataset.GetRasterBand(1)->RasterIO(direction, 0, layout.ny - iy_begin - count, layout.nx, count, north_row,
                                            layout.nx, count, GDT_Float32, sizeof(float), -line, nullptr) == CE_None;
}

/// NaN in one bit pattern; infinities are a defect of the caller.
bool canonical(std::span<float> values) {
  for (float& value : values) {
    if (std::isnan(value)) value = std::numeric_limits<float>::quiet_NaN();
    if (std::isinf(value)) return false;
  }
  return true;
}

void describe(GDALDataset& dataset, const Job& job, const RasterStatistics& statistics) {
  dataset.SetSpatialRef(&job.crs);
  const RasterLayout& layout = job.layout;
  double transform[6] = {layout.origin.x(), layout.cell_m, 0, layout.origin.y() + layout.ny * layout.cell_m, 0,
                         -layout.cell_m};
  dataset.SetGeoTransform(transform);
  dataset.SetMetadataItem("AREA_OR_POINT", "Area");
  dataset.SetMetadataItem("product", clean_text(layout.name).c_str());
  for (const auto& [key, value] : job.options.metadata) dataset.SetMetadataItem(key.c_str(), clean_text(value).c_str());
  GDALRasterBand* band = dataset.GetRasterBand(1);
  band->SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
  band->SetUnitType(clean_text(layout.unit).c_str());
  band->SetDescription(clean_text(layout.description.empty() ? layout.name : layout.description).c_str());
  for (const auto& [key, value] : statistics.metadata()) band->SetMetadataItem(key.c_str(), value.c_str());
}

struct Written {
  std::string sha256;  ///< of the values, band by band as they came
  RasterStatistics statistics;
};

/// Streams the rows into a plain tiled GeoTIFF, which random access (overviews, tiling) then works on.
Result<Written> write_working_copy(const Job& job, const std::string& path) {
  const RasterLayout& layout = job.layout;
  CPLStringList creation;
  creation.SetNameValue("BIGTIFF", "IF_SAFER");
  if (job.options.profile == GeoTiffOptions::Profile::cloud_optimised) {
    creation.SetNameValue("TILED", "YES");
    creation.SetNameValue("BLOCKXSIZE", "512");
    creation.SetNameValue("BLOCKYSIZE", "512");
  }
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  if (driver == nullptr) return fail(ErrorCode::internal, kWhat, job.staged.target(), "GDAL lacks the GTiff driver");
  DatasetPtr dataset(driver->Create(path.c_str(), layout.nx, layout.ny, 1, GDT_Float32, creation.List()));
  if (dataset == nullptr) return job.gdal.failure(kWhat, job.staged.target());

  Written written;
  Sha256 hash;
  std::vector<float> values;
  const auto take_band = [&](int iy_begin, int count) -> Result<void> {
    values.assign(static_cast<std::size_t>(count) * static_cast<std::size_t>(layout.nx),
                  std::numeric_limits<float>::quiet_NaN());
    RAYFIELD_CHECK(job.read(iy_begin, count, values));
    if (!canonical(values)) {
      return fail(ErrorCode::internal, kWhat, job.staged.target(),
                  fmt::format("a cell in rows {} … {} is infinite", iy_begin, iy_begin + count - 1));
    }
    // Row by row from the north, so that sums do not depend on the number of rows in a band.
    const auto width = static_cast<std::size_t>(layout.nx);
    for (std::size_t row = static_cast<std::size_t>(count); row-- > 0;) {
      written.statistics.add(std::span<const float>(values).subspan(row * width, width));
    }
    hash.update(std::as_bytes(std::span<const float>(values)));
    if (!transfer(*dataset, GF_Write, layout, iy_begin, count, values.data())) {
      return job.gdal.failure(kWhat, job.staged.target());
    }
    return {};
  };
  RAYFIELD_CHECK(for_each_band(layout, job.options.rows_per_band, take_band));
  written.sha256 = hash.hex();
  describe(*dataset, job, written.statistics);
  dataset.reset();
  if (job.gdal.failed()) return job.gdal.failure(kWhat, job.staged.target());
  return written;
}

Result<void> copy_to_cog(const Job& job, const std::string& from, const std::string& to) {
  DatasetPtr source(GDALDataset::Open(from.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("COG");
  if (source == nullptr || driver == nullptr) return job.gdal.failure(kWhat, job.staged.target());
  CPLStringList creation;
  const bool zstd = job.options.compression == GeoTiffOptions::Compression::zstd;
  creation.SetNameValue("COMPRESS", zstd ? "ZSTD" : "DEFLATE");
  creation.SetNameValue("LEVEL", zstd ? "9" : "6");
  creation.SetNameValue("PREDICTOR", "FLOATING_POINT");
  creation.SetNameValue("OVERVIEW_PREDICTOR", "FLOATING_POINT");
  creation.SetNameValue("BLOCKSIZE", std::to_string(job.options.block_size).c_str());
  creation.SetNameValue("OVERVIEW_RESAMPLING", "AVERAGE");
  creation.SetNameValue("NUM_THREADS", "1");
  creation.SetNameValue("BIGTIFF", "IF_SAFER");
  DatasetPtr copy(driver->CreateCopy(to.c_str(), source.get(), FALSE, creation.List(), nullptr, nullptr));
  if (copy == nullptr) return job.gdal.failure(kWhat, job.staged.target());
  copy.reset();
  if (job.gdal.failed()) return job.gdal.failure(kWhat, job.staged.target());
  return {};
}

/// A close can fail without saying so: what the file holds is compared with what was handed over.
Result<void> verify_values(const Job& job, const std::string& path, const std::string& sha256) {
  DatasetPtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
  if (dataset == nullptr) return job.gdal.failure(kWhat, job.staged.target());
  Sha256 hash;
  std::vector<float> values;
  const auto read_band = [&](int iy_begin, int count) -> Result<void> {
    values.resize(static_cast<std::size_t>(count) * static_cast<std::size_t>(job.layout.nx));
    if (!transfer(*dataset, GF_Read, job.layout, iy_begin, count, values.data())) {
      return job.gdal.failure(kWhat, job.staged.target());
    }
    hash.update(std::as_bytes(std::span<const float>(values)));
    return {};
  };
  RAYFIELD_CHECK(for_each_band(job.layout, job.options.rows_per_band, read_band));
  if (hash.hex() != sha256) {
    return fail(ErrorCode::resources, kWhat, job.staged.target(), "the file reads back other values than were written",
                "check the disk");
  }
  return {};
}

Result<void> publish_all(const Job& job, const std::string& file, const RasterStatistics& statistics) {
  namespace fs = std::filesystem;
  const fs::path target(job.staged.target());
  if (job.options.write_style) {
    const ColorScale scale =
        job.options.scale.value_or(product_scale(job.layout.name, statistics.minimum(), statistics.maximum()));
    const std::string style = qml::document(qml::raster_style(scale, job.layout.unit));
    RAYFIELD_CHECK(write_whole_file(job.staged.path("style.qml"), std::as_bytes(std::span(style)), kWhat));
  }
  // GDAL would prefer an older file's sidecar statistics to those inside the new one.
  std::error_code ignored;
  fs::remove(target.string() + ".aux.xml", ignored);
  RAYFIELD_CHECK(job.staged.publish(file));
  if (!job.options.write_style) return {};
  return job.staged.publish("style.qml", fs::path(target).replace_extension(".qml").string());
}

Result<void> write_raster(const RasterLayout& layout, const RowReader& read, const std::string& crs,
                          const std::string& path, const GeoTiffOptions& options) {
  RAYFIELD_CHECK(options.validate());
  RAYFIELD_CHECK(check_layout(layout, path));
  GdalSession gdal;
  RAYFIELD_ASSIGN(const OGRSpatialReference reference, parse_crs(crs, kWhat, path));
  RAYFIELD_ASSIGN(const StagedOutput staged, StagedOutput::create(path, kWhat));
  const Job job{layout, read, reference, staged, options, gdal};
  const std::string working = staged.path("working.tif");
  RAYFIELD_ASSIGN(const Written written, write_working_copy(job, working));
  std::string file = "working.tif";
  if (options.profile == GeoTiffOptions::Profile::cloud_optimised) {
    file = "cog.tif";
    RAYFIELD_CHECK(copy_to_cog(job, working, staged.path(file)));
  }
  RAYFIELD_CHECK(verify_values(job, staged.path(file), written.sha256));
  return publish_all(job, file, written.statistics);
}

}  // namespace

Result<void> GeoTiffOptions::validate() const {
  const auto bad = [](std::string_view why) { return fail(ErrorCode::usage, "bad GeoTIFF options", "", why); };
  if (block_size < 128 || block_size > 4096 || block_size % 16 != 0) {
    return bad("block_size must be a multiple of 16 from 128 to 4096");
  }
  if (rows_per_band < 1 || rows_per_band > 65536) return bad("rows_per_band must be 1 to 65536");
  if (scale && !(scale->low < scale->high && std::isfinite(scale->low) && std::isfinite(scale->high))) {
    return bad("the colour scale needs low < high");
  }
  for (const auto& [key, value] : metadata) {
    const bool good = !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
      return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
    });
    if (!good) return bad("metadata keys must be letters, digits and underscores");
  }
  return {};
}

Result<void> write_cog(const RasterLayout& layout, const RowReader& read, const std::string& crs,
                       const std::string& path, const GeoTiffOptions& options) {
  return guarded(kWhat, path, [&] { return write_raster(layout, read, crs, path, options); });
}

Result<void> write_cog(const RasterProduct& raster, const std::string& crs, const std::string& path,
                       const GeoTiffOptions& options) {
  const Grid2<float>& grid = raster.grid;
  const auto width = static_cast<std::size_t>(std::max(grid.nx, 0));
  if (grid.values.size() != width * static_cast<std::size_t>(std::max(grid.ny, 0)))
    return fail(ErrorCode::internal, kWhat, path, "the grid's size and its number of values disagree");
  const RowReader rows = [&grid, width](int iy_begin, int count, std::span<float> values) -> Result<void> {
    const auto first = grid.values.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(iy_begin) * width);
    std::copy_n(first, static_cast<std::size_t>(count) * width, values.begin());
    return {};
  };
  return write_cog({raster.name, raster.unit, raster.description, grid.origin, grid.cell_m, grid.nx, grid.ny}, rows,
                   crs, path, options);
}

Result<void> write_raster_style(const ColorScale& scale, const std::string& unit, const std::string& path) {
  constexpr std::string_view kStyleWhat = "cannot write style";
  return guarded(kStyleWhat, path, [&]() -> Result<void> {
    RAYFIELD_CHECK(GeoTiffOptions{.scale = scale}.validate());
    return write_file_atomically(path, qml::document(qml::raster_style(scale, unit)), kStyleWhat);
  });
}

}  // namespace rayfield::formats
