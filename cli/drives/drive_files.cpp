#include "cli/drives/drive_files.h"

#include <fmt/core.h>

#include "rayfield/formats/trajectory_file.h"

namespace rayfield::cli {

Result<void> keep_drive_files(const RegisteredDrive& drive, std::vector<tile::NewAttachment>& files) {
  constexpr std::size_t kFilesOfADrive = 2;
  const std::size_t number = files.size() / kFilesOfADrive + 1;
  const std::string suffix = number == 1 ? std::string() : fmt::format("_{}", number);
  slam::SlamReport report = drive.report;
  report.stages.clear();
  RAYFIELD_ASSIGN(std::string trajectory,
                  formats::pack_trajectory({drive.trajectory->poses, drive.trajectory->crs, "IMU"}));
  files.push_back({"slam" + suffix + ".json", slam::report_json(report) + "\n"});
  files.push_back({"trajectory" + suffix + ".tum.bz2", std::move(trajectory)});
  return {};
}

}  // namespace rayfield::cli
