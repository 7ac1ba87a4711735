#pragma once

#include <filesystem>

#include "cli/console/output_paths.h"
#include "rayfield/core/file.h"
#include "rayfield/core/result.h"

namespace rayfield::cli {

/// A folder that appears whole: files are written to `.<name>.part` beside it, which takes its name when all is done.
/// Removed when it is never published; what a killed program leaves is removed by the next one.
class StagedFolder {
 public:
  /// Makes the folders above it, too. Errors: resources, usage (another program is writing the same folder; in a
  /// store).
  static Result<StagedFolder> create(const std::filesystem::path& target);
  StagedFolder(StagedFolder&& other) noexcept;
  StagedFolder& operator=(StagedFolder&&) = delete;
  ~StagedFolder();

  const std::filesystem::path& path() const { return path_; }
  /// Into a folder that is there already, files move one by one: others in it stay.
  Result<void> publish();

 private:
  StagedFolder(std::filesystem::path target, std::filesystem::path path, OutputFolder parent, FileDescriptor lock)
      : target_(std::move(target)), path_(std::move(path)), parent_(std::move(parent)), lock_(std::move(lock)) {}
  std::filesystem::path target_, path_;
  OutputFolder parent_;
  FileDescriptor lock_;
};

}  // namespace rayfield::cli
