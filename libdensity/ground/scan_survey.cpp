#include "libdensity/ground/scan_survey.h"

#include "libdensity/tiles/fixed_point.h"

namespace rayfield::density {

void ScanSurvey::add(const TileSurvey& survey) {
  path_step_s_ = survey.path_step_s;
  for (const PathSum& sum : survey.path) {
    const auto [it, fresh] = path_.try_emplace(sum.step, sum);
    if (!fresh) it->second += sum;
  }
  coverage_[survey.index] = survey.coverage;
  misses_ += survey.misses;
}

std::vector<PathPoint> ScanSurvey::path() const {
  std::vector<PathPoint> path;
  path.reserve(path_.size());
  for (const auto& [step, sum] : path_) {
    const double n = static_cast<double>(sum.count);
    path.push_back(
        {(static_cast<double>(step) + 0.5) * path_step_s_,
         Eigen::Vector3d(metres_from_fixed(sum.east), metres_from_fixed(sum.north), metres_from_fixed(sum.up)) / n});
  }
  return path;
}

}  // namespace rayfield::density
