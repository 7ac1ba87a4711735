#include "cli/drives/drive_needs.h"

namespace rayfield::cli {
namespace {

constexpr std::uint64_t kCloudBytesPerRay = 48;               // docs/ray-cloud-ply.md
constexpr double kSurfelBytesPerSecond = 0.15e6;              // of driving, docs/architecture.md, "Memory"
constexpr double kTrajectoryBytesPerSecond = 40e3;            // the same
constexpr std::uint64_t kProgram = std::uint64_t{256} << 20;  // program, libraries, window, surfels of a square

double duration_s(const OpenedLog& log) {
  const auto& segments = log.report.segments;
  const auto chosen = static_cast<std::size_t>(log.report.segment);
  return chosen < segments.size() ? segments[chosen].last_s - segments[chosen].first_s : 0;
}

}  // namespace

std::uint64_t rays_of(const OpenedLog& log) { return log.report.points.returns + log.report.points.no_returns; }

Needs registration_needs(const OpenedLog& log) {
  const double seconds = duration_s(log);
  return {0, static_cast<std::uint64_t>(kSurfelBytesPerSecond * seconds),
          kProgram + static_cast<std::uint64_t>(kTrajectoryBytesPerSecond * seconds)};
}

Needs slam_needs(const OpenedLog& log) {
  Needs needs = registration_needs(log);
  needs.disk_bytes = kCloudBytesPerRay * rays_of(log);
  return needs;
}

}  // namespace rayfield::cli
