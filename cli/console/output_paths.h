#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rayfield/core/file.h"
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

/// Outputs of a command that takes long, held against other programs until the end of this object. What was not there
/// before is removed again unless keep() is called: a command that failed half-way can be run again as it was.
class NewOutputs {
 public:
  /// Holds an output by a locked folder `.<file>.part-lock` beside it; what a killed program leaves of that is taken
  /// over. Errors: usage (another program is writing it), as fail_output().
  static Result<NewOutputs> hold(std::span<const OutputPath> outputs);
  NewOutputs(NewOutputs&&) noexcept = default;
  NewOutputs& operator=(NewOutputs&&) = delete;
  ~NewOutputs();
  void keep() { new_.clear(); }

 private:
  NewOutputs() = default;
  std::vector<std::string> new_;
  std::vector<std::pair<std::string, FileDescriptor>> held_;  // folders that are locked
};

}  // namespace rayfield::cli
