#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "cli/console/output_paths.h"
#include "rayfield/core/result.h"
#include "rayfield/formats/product_folder.h"

namespace rayfield::cli {

/// The folder that products are exported to. They appear in it together, and with them a list,
/// `<block>_products.json` (docs/products.md), that names each with its SHA-256 and what it was made of. Another export
/// may keep the products that it would make of the same. A folder that was made for nothing goes again.
class ExportFolder {
 public:
  /// `keep`: leave what is made of the same as it is. Errors: as ProductFolder::create().
  static Result<ExportFolder> open(const std::filesystem::path& folder, const std::string& block, bool keep);

  /// Whether the folder holds a complete export of `content`, byte for byte; its products are then those of this one.
  bool holds(const std::string& content);

  /// Whether to write a product: true, unless it is kept because the folder holds it, made of `source` and unchanged
  /// since. `source` names everything that the product depends on. Styles (`.qml`) do not count as products.
  bool wants(const std::string& name, const std::string& source);
  /// Whether the folder holds a file of that name, of this or of an earlier export.
  bool has(const std::string& name) const;
  /// Where to write it.
  std::string path(const std::string& name) const { return products_.path(name); }
  /// Where files without a name may be made while the work goes on.
  std::filesystem::path scratch() const { return std::filesystem::path(path("file")).parent_path(); }

  /// Publishes what was written, and the list. `content` names all that was exported, for holds().
  Result<void> publish(std::uint64_t snapshot, const std::string& content);

  /// Products of this export in the order in which they were asked for, and how many of them were written.
  std::vector<std::filesystem::path> products() const;
  std::size_t written_count() const { return written_; }

 private:
  struct Entry {
    std::uint64_t snapshot = 0, size = 0;
    std::string sha256, source;
  };
  ExportFolder(std::filesystem::path folder, std::string block, bool keep, OutputFolder made,
               formats::ProductFolder products);
  std::string list_name() const;
  void read_list();
  bool intact(const std::string& name) const;

  std::filesystem::path folder_;
  std::string block_;
  bool keep_;
  OutputFolder made_;  // before what is written into it, and so gone after that
  formats::ProductFolder products_;
  std::string listed_content_;
  std::vector<std::string> listed_products_;    // that listed_content_ consists of
  std::map<std::string, Entry> listed_;         // by name, also of earlier exports to the folder
  std::map<std::string, std::string> sources_;  // of this export, by name
  std::vector<std::string> names_;              // of this export
  std::size_t written_ = 0;
};

}  // namespace rayfield::cli
