#pragma once

#include <string>
#include <string_view>

#include "rayfield/core/file.h"
#include "rayfield/core/result.h"

namespace rayfield::formats {

/// Products appear whole or not at all. Work goes on in a private folder `.<file>.part-XXXXXX` beside the target (mode
/// 0700, unpredictable name, so that drivers may put their own temporary and sidecar files there); publish() syncs the
/// finished files, renames them into place and syncs the folder. The destructor removes what is left. The folder is
/// locked while in use; folders whose owner was killed are removed by the next writer of the same target.
class StagedOutput {
 public:
  /// `target`: the product's path; `what` opens error messages ("cannot write GeoTIFF").
  /// Errors: no such folder → bad_input; no permission, read-only, disk full → resources; target is a folder → usage.
  static Result<StagedOutput> create(const std::string& target, std::string_view what);

  StagedOutput(StagedOutput&& other) noexcept;
  StagedOutput& operator=(StagedOutput&&) = delete;
  ~StagedOutput();

  /// Path inside the private folder.
  std::string path(std::string_view file_name) const;
  /// Moves `file_name` to the target. Errors: as create().
  Result<void> publish(std::string_view file_name) const { return publish(file_name, target_); }
  /// Moves `file_name` to `destination`, a path in the target's folder.
  Result<void> publish(std::string_view file_name, const std::string& destination) const;

  const std::string& target() const { return target_; }
  const std::string& what() const { return what_; }

 private:
  StagedOutput() = default;
  std::string target_, what_, parent_, folder_;
  FileDescriptor lock_;  ///< of the private folder
};

/// Stages and publishes one small text or image file.
Result<void> write_file_atomically(const std::string& target, std::string_view bytes, std::string_view what);

}  // namespace rayfield::formats
