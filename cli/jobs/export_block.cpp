#include "cli/jobs/export_block.h"

#include <fmt/core.h>

#include "rayfield/density/load.h"
#include "rayfield/formats/formats.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

using Paths = std::vector<fs::path>;

// The rasters of one scan, and the picture of its density map.
Result<void> export_rasters(const tile::Store& store, const tile::Snapshot& snapshot, const tile::ScanEntry& scan,
                            const BlockProducts& block, const fs::path& folder, const ExportOptions& options,
                            Paths& written) {
  for (const std::string& name : density::raster_names(scan)) {
    RAYFIELD_ASSIGN(const RasterProduct raster, density::load_raster(store, snapshot, scan, name));
    const std::string stem = fmt::format("{}_{}_{}", block.block, scan.scan_id, name);
    if (options.formats.count("geotiff") > 0) {
      formats::GeoTiffOptions tiff;
      tiff.metadata = {{"scan_id", scan.scan_id}, {"scan_date", scan.date}};
      written.push_back(folder / (stem + ".tif"));
      RAYFIELD_CHECK(formats::write_cog(raster, block.crs, written.back().string(), tiff));
    }
    if (options.formats.count("png") > 0 && raster.name == "plan_density") {
      formats::PictureOptions picture;
      picture.title = block.block;
      picture.subtitle = scan.name.empty() ? scan.date : scan.date + ", " + scan.name;
      written.push_back(folder / (stem + ".png"));
      RAYFIELD_CHECK(
          formats::write_plan_picture(raster, formats::block_overlay(block), written.back().string(), picture));
    }
  }
  return {};
}

// Side views of all rows on one sheet, end-on sections on another.
Result<void> export_sections(const ScanResults& results, const BlockProducts& block, const fs::path& folder,
                             Paths& written) {
  for (const auto& [kind, title] : {std::pair{"side_view", "side views"}, std::pair{"end_on", "end-on sections"}}) {
    std::vector<formats::LabelledSection> sheet;
    for (const SectionProduct& section : results.sections) {
      if (section.name.rfind(kind, 0) != 0) continue;
      formats::LabelledSection labelled{&section, fmt::format("row {}", section.row_number), {}};
      if (std::string_view(kind) == "side_view") {
        for (const PostProduct& post : block.posts)
          if (post.row_number == section.row_number) labelled.marks_m.push_back(post.chainage_m);
      }
      sheet.push_back(std::move(labelled));
    }
    if (sheet.empty()) continue;
    formats::PictureOptions picture;
    picture.title = fmt::format("{}, {}", block.block, title);
    picture.subtitle = results.scan.scan_date;
    written.push_back(folder / fmt::format("{}_{}_{}.png", block.block, results.scan.scan_id, kind));
    RAYFIELD_CHECK(formats::write_section_picture(sheet, written.back().string(), picture));
  }
  return {};
}

}  // namespace

Result<std::vector<fs::path>> export_block(const tile::Store& store, const fs::path& folder,
                                           const ExportOptions& options, Progress& progress) {
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  RAYFIELD_ASSIGN(const std::vector<std::string> scan_ids, density::select_scans(snapshot, options.dates));
  RAYFIELD_ASSIGN(const BlockProducts block, density::load_block(store, snapshot, scan_ids));
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) return fail_errno(failed.value(), "cannot make folder", folder.string(), "give another -o");

  Paths written;
  progress.stage("export", scan_ids.size() + 1, "steps");
  if (options.formats.count("gpkg") > 0) {
    written.push_back(folder / (block.block + ".gpkg"));
    RAYFIELD_CHECK(formats::write_geopackage(block, written.back().string()));
  }
  if (options.formats.count("csv") > 0) {
    written.push_back(folder / (block.block + "_panels.csv"));
    RAYFIELD_CHECK(formats::write_panels_csv(block, written.back().string()));
    written.push_back(folder / (block.block + "_row_metres.csv"));
    RAYFIELD_CHECK(formats::write_row_metres_csv(block, written.back().string()));
  }
  for (std::size_t i = 0; i < block.scans.size() && options.formats.count("geojson") > 0; ++i) {
    written.push_back(folder / fmt::format("{}_{}_panels.geojson", block.block, block.scans[i].scan.scan_id));
    RAYFIELD_CHECK(formats::write_panels_geojson(block, i, written.back().string()));
  }
  progress.advance(1);
  for (const ScanResults& results : block.scans) {
    if (progress.cancelled())
      return fail(ErrorCode::interrupted, "interrupted", folder.string(), "", "run the same command again");
    const tile::ScanEntry& scan = *snapshot.find_scan(results.scan.scan_id);
    RAYFIELD_CHECK(export_rasters(store, snapshot, scan, block, folder, options, written));
    if (options.formats.count("png") > 0) RAYFIELD_CHECK(export_sections(results, block, folder, written));
    progress.advance(1);
  }
  return written;
}

}  // namespace rayfield::cli
