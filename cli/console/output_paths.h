#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::cli {

/// A file that a command is asked to write.
struct OutputPath {
  std::string option;  ///< "--trajectory"
  std::string what;    ///< "cannot write trajectory"
  std::string path;
};

/// That an output does not lie in a store, nor in place of one: what is in that folder is the store's, and `gc` and
/// `verify` look after it. `what`: "cannot export", `next`: "give another -o". Errors: usage.
Result<void> check_outside_stores(const std::filesystem::path& output, std::string_view what, std::string_view next);

/// Checks before hours of work what would make writing fail after them: that each path names a file in a folder that
/// can be written to and is no store's, is not there already (unless `overwrite`), and is neither one of `inputs` nor
/// given twice.
/// Errors: usage, resources (no permission, no space for a file).
Result<void> check_outputs(std::span<const OutputPath> outputs, std::span<const std::string> inputs, bool overwrite);

/// A folder for products. It and those above it are made where they are missing, their names durable; what was made and
/// is still empty at the end of this object goes again, so that a refused command leaves no folder behind.
class OutputFolder {
 public:
  /// Errors: usage (in a store), as fail_output().
  static Result<OutputFolder> make(const std::filesystem::path& folder);
  OutputFolder(OutputFolder&& other) noexcept : made_(std::exchange(other.made_, {})) {}
  OutputFolder& operator=(OutputFolder&&) = delete;
  ~OutputFolder();

 private:
  OutputFolder() = default;
  std::vector<std::filesystem::path> made_;  // the deepest first
};

/// Outputs that are not there yet. What of them has appeared is removed again unless keep() is called: a command that
/// failed half-way can be run again as it was.
class NewOutputs {
 public:
  explicit NewOutputs(std::span<const OutputPath> outputs);
  NewOutputs(const NewOutputs&) = delete;
  NewOutputs& operator=(const NewOutputs&) = delete;
  ~NewOutputs();
  void keep() { paths_.clear(); }

 private:
  std::vector<std::string> paths_;
};

}  // namespace rayfield::cli
