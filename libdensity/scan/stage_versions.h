#pragma once

#include <vector>

namespace rayfield::density {

/// Versions of the stages' code, raised whenever a stage computes something else from the same input. They stand
/// together because a scan that is whole (processed_scan.h) was made by all of them.
inline constexpr int kSurveyVersion = 2;
inline constexpr int kGroundVersion = 1;
inline constexpr int kEvidenceVersion = 4;
inline constexpr int kGeometryVersion = 5;
inline constexpr int kProfileVersion = 1;
inline constexpr int kVoxelSizeVersion = 5;
inline constexpr int kSpotsVersion = 1;
inline constexpr int kEchoesVersion = 36;
inline constexpr int kLeafAnglesVersion = 9;
inline constexpr int kRowSegmentsVersion = 2;
inline constexpr int kVoxelsVersion = 5;
inline constexpr int kResultsVersion = 32;
inline constexpr int kEstimationVersion = 1;
inline constexpr int kTotalsVersion = 4;
inline constexpr int kLeafVersion = 23;
inline constexpr int kLeafByEstimateVersion = 19;

inline std::vector<double> stage_versions() {
  return {kSurveyVersion,     kGroundVersion,      kEvidenceVersion, kGeometryVersion,
          kProfileVersion,    kVoxelSizeVersion,   kSpotsVersion,    kEchoesVersion,
          kLeafAnglesVersion, kRowSegmentsVersion, kVoxelsVersion,   kResultsVersion,
          kEstimationVersion, kTotalsVersion,      kLeafVersion,     kLeafByEstimateVersion};
}

}  // namespace rayfield::density
