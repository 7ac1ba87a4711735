#include "cli/products/export_pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <vector>

#include "cli/products/export_source.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/density/load.h"
#include "rayfield/formats/formats.h"

namespace rayfield::cli {
namespace {

// Formats, which are also the endings of the files.
constexpr std::array<const char*, 2> kPictureFormats{"png", "svg"};

// What lies over the plan views.
std::string overlay_source(const BlockProducts& block) {
  Source source("overlay");
  for (const RowProduct& row : block.rows) {
    source.add(row.row_number);
    for (const Eigen::Vector2d& p : row.centreline) source.add(p.x()).add(p.y());
  }
  for (const PanelProduct& panel : block.panels) {
    source.add(panel.panel_number);
    for (const Eigen::Vector2d& p : panel.outline) source.add(p.x()).add(p.y());
  }
  for (const PostProduct& post : block.posts)
    source.add(post.position.x()).add(post.position.y()).add(post.chainage_m).add(post.detected ? 1 : 0);
  return source.hex();
}

// What is marked in the side views.
std::string posts_source(const BlockProducts& block) {
  Source source("posts");
  for (const PostProduct& post : block.posts) source.add(post.row_number).add(post.chainage_m);
  return source.hex();
}

std::string date_of(const ScanProduct& scan) {
  return scan.name.empty() ? scan.scan_date : scan.scan_date + ", " + scan.name;
}

// The files of a picture that are to be written, by their names.
std::vector<std::string> wanted_files(const PictureExport& pictures, const std::string& stem, const std::string& source,
                                      ExportFolder& folder) {
  std::vector<std::string> files;
  for (const char* format : kPictureFormats)
    if (const std::string name = fmt::format("{}.{}", stem, format);
        pictures.options.formats.count(format) > 0 && folder.wants(name, source))
      files.push_back(name);
  return files;
}

Result<void> export_plan(const PictureExport& pictures, const ScanProduct& scan, ExportFolder& folder) {
  constexpr const char* kName = "plan_density";
  const tile::ScanEntry& entry = *pictures.snapshot.find_scan(scan.scan_id);
  const formats::ColorScale& scale = pictures.scales.at(kName);
  const std::string source = Source("plan picture")
                                 .add(date_of(scan))
                                 .add(pictures.layout)
                                 .add(pictures.reference)
                                 .add(overlay_source(pictures.block))
                                 .add(scale_source(scale))
                                 .add(derived_sha256(entry, "raster", kName))
                                 .hex();
  const auto files =
      wanted_files(pictures, fmt::format("{}_{}_{}", pictures.block.block, scan.scan_id, kName), source, folder);
  if (files.empty()) return {};
  RAYFIELD_ASSIGN(const RasterProduct raster, density::load_raster(pictures.store, pictures.snapshot, entry, kName));
  formats::PictureOptions picture;
  picture.scale = scale;
  picture.title = pictures.block.block;
  picture.subtitle = date_of(scan) + "   " + pictures.reference;
  for (const std::string& name : files)
    RAYFIELD_CHECK(
        formats::write_plan_picture(raster, formats::block_overlay(pictures.block), folder.path(name), picture));
  return {};
}

// Side views of all rows on one sheet, end-on sections on another.
Result<void> export_sections(const PictureExport& pictures, const ScanProduct& scan, const std::string& kind,
                             const std::string& title, ExportFolder& folder) {
  const tile::ScanEntry& entry = *pictures.snapshot.find_scan(scan.scan_id);
  const formats::ColorScale& scale = pictures.scales.at(kind);
  const std::string source = Source("sections")
                                 .add(date_of(scan))
                                 .add(scale_source(scale))
                                 .add(derived_sha256(entry, "results", "block"))
                                 .add(posts_source(pictures.block))
                                 .hex();
  const auto files =
      wanted_files(pictures, fmt::format("{}_{}_{}", pictures.block.block, scan.scan_id, kind), source, folder);
  if (files.empty()) return {};
  RAYFIELD_ASSIGN(const std::vector<SectionProduct> sections,
                  density::load_sections(pictures.store, pictures.snapshot, entry, kind));
  std::vector<formats::LabelledSection> sheet;
  for (const SectionProduct& section : sections) {
    formats::LabelledSection labelled{&section, fmt::format("row {}", section.row_number), {}};
    for (const PostProduct& post : pictures.block.posts)
      if (kind == "side_view" && post.row_number == section.row_number) labelled.marks_m.push_back(post.chainage_m);
    sheet.push_back(std::move(labelled));
  }
  formats::PictureOptions picture;
  picture.title = fmt::format("{}, {}", pictures.block.block, title);
  picture.subtitle = date_of(scan);
  picture.scale = scale;
  const auto write =
      kind == "end_on" ? formats::write_end_on_picture
                       : static_cast<Result<void> (*)(std::span<const formats::LabelledSection>, const std::string&,
                                                      const formats::PictureOptions&)>(formats::write_section_picture);
  for (const std::string& name : files) RAYFIELD_CHECK(write(sheet, folder.path(name), picture));
  return {};
}

}  // namespace

bool wants_pictures(const ExportOptions& options) {
  return std::any_of(kPictureFormats.begin(), kPictureFormats.end(),
                     [&](const char* format) { return options.formats.count(format) > 0; });
}

std::string reference_name(const std::string& crs) {
  const auto info = lookup_projected_crs(crs);
  if (!info) return crs;
  return info->code == info->name ? info->name : fmt::format("{} ({})", info->name, info->code);
}

Result<void> export_pictures(const PictureExport& pictures, const ScanResults& results, ExportFolder& folder) {
  if (!wants_pictures(pictures.options)) return {};
  RAYFIELD_CHECK(export_plan(pictures, results.scan, folder));
  // A scan that shows no row has neither half metres nor sections.
  if (results.row_metres.empty()) return {};
  RAYFIELD_CHECK(export_sections(pictures, results.scan, "side_view", "side views", folder));
  return export_sections(pictures, results.scan, "end_on", "end-on sections", folder);
}

}  // namespace rayfield::cli
