#include "cli/products/export_folder.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>

#include "rayfield/core/file.h"
#include "rayfield/core/text_file.h"
#include "rayfield/tile/whole_number.h"
#include "version.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kWhat = "cannot export";
constexpr const char* kFormat = "rayfield-products";
constexpr int kVersionOfList = 1;

bool is_style(const std::string& name) { return name.ends_with(".qml"); }

bool is_there(const fs::path& path, std::uint64_t size, const std::string& sha256) {
  std::error_code error;
  if (fs::file_size(path, error) != size || error) return false;
  const auto digest = digest_file(path.string(), kWhat);
  return digest && digest->sha256 == sha256;
}

}  // namespace

ExportFolder::ExportFolder(fs::path folder, std::string block, bool keep, OutputFolder made,
                           formats::ProductFolder products)
    : folder_(std::move(folder)),
      block_(std::move(block)),
      keep_(keep),
      made_(std::move(made)),
      products_(std::move(products)) {
  read_list();
}

std::string ExportFolder::list_name() const { return block_ + "_products.json"; }

Result<ExportFolder> ExportFolder::open(const fs::path& folder, const std::string& block, bool keep) {
  RAYFIELD_ASSIGN(OutputFolder made, OutputFolder::make(folder));
  RAYFIELD_ASSIGN(formats::ProductFolder products,
                  formats::ProductFolder::create(folder.string(), block + "_products.json", kWhat));
  return ExportFolder(folder, block, keep, std::move(made), std::move(products));
}

// A list that cannot be read, or is of another version, counts as none: everything is written.
void ExportFolder::read_list() {
  const auto text = read_text_file((folder_ / list_name()).string(), kWhat);
  if (!text) return;
  const ordered_json json = ordered_json::parse(*text, nullptr, false);
  try {
    if (json.at("format") != kFormat || json.at("version") != kVersionOfList) return;
    listed_content_ = json.at("content").get<std::string>();
    for (const ordered_json& file : json.at("files")) {
      const auto name = file.at("name").get<std::string>();
      listed_[name] = {tile::whole_number<std::uint64_t>(file.at("snapshot")),
                       tile::whole_number<std::uint64_t>(file.at("size")), file.at("sha256").get<std::string>(),
                       file.at("source").get<std::string>()};
      if (file.at("of_this_export").get<bool>()) listed_products_.push_back(name);
    }
  } catch (const std::exception&) {
    listed_.clear(), listed_products_.clear(), listed_content_.clear();
  }
}

bool ExportFolder::intact(const std::string& name) const {
  const auto found = listed_.find(name);
  return found != listed_.end() && is_there(folder_ / name, found->second.size, found->second.sha256);
}

bool ExportFolder::holds(const std::string& content) {
  const bool whole = keep_ && listed_content_ == content &&
                     std::all_of(listed_products_.begin(), listed_products_.end(),
                                 [this](const std::string& name) { return intact(name); });
  if (whole)
    std::copy_if(listed_products_.begin(), listed_products_.end(), std::back_inserter(names_),
                 [](const std::string& name) { return !is_style(name); });
  return whole;
}

bool ExportFolder::wants(const std::string& name, const std::string& source) {
  if (!is_style(name)) names_.push_back(name);
  sources_[name] = source;
  const auto found = listed_.find(name);
  const bool kept = keep_ && found != listed_.end() && found->second.source == source && intact(name);
  if (!kept && !is_style(name)) ++written_;
  return !kept;
}

bool ExportFolder::has(const std::string& name) const {
  std::error_code ignored;
  return fs::exists(folder_ / name, ignored);
}

Result<void> ExportFolder::publish(std::uint64_t snapshot, const std::string& content) {
  RAYFIELD_ASSIGN(const std::vector<formats::ProductFile> files, products_.files());
  std::string source;  // a style without one of its own came with its raster
  for (const formats::ProductFile& file : files) {
    const fs::path raster = fs::path(file.name).replace_extension(".tif");
    const auto own = sources_.find(file.name), with = sources_.find(raster.string());
    source = own != sources_.end() ? own->second : with != sources_.end() ? with->second : std::string();
    listed_[file.name] = {snapshot, file.size, file.sha256, source};
  }
  ordered_json list = ordered_json::array();
  for (const auto& [name, entry] : listed_) {
    std::error_code error;
    const bool written = std::any_of(files.begin(), files.end(),
                                     [&file_name = name](const auto& file) { return file.name == file_name; });
    if (!written && !fs::exists(folder_ / name, error)) continue;
    const std::string raster = fs::path(name).replace_extension(".tif").string();
    list.push_back({{"name", name},
                    {"of_this_export", written || sources_.contains(name) || sources_.contains(raster)},
                    {"snapshot", entry.snapshot},
                    {"size", entry.size},
                    {"sha256", entry.sha256},
                    {"source", entry.source}});
  }
  const ordered_json document = {{"format", kFormat},       {"version", kVersionOfList}, {"block", block_},
                                 {"snapshot", snapshot},    {"software", kVersion},      {"content", content},
                                 {"files", std::move(list)}};
  const std::string text = document.dump(1) + "\n";
  RAYFIELD_CHECK(write_whole_file(products_.path(list_name()), std::as_bytes(std::span(text)), kWhat));
  return products_.publish();
}

std::vector<fs::path> ExportFolder::products() const {
  std::vector<fs::path> paths;
  for (const std::string& name : names_) paths.push_back(folder_ / name);
  return paths;
}

}  // namespace rayfield::cli
