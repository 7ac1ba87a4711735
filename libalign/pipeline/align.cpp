#include "rayfield/align/align.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libalign/pose/hypotheses.h"
#include "libalign/pose/pose_fit.h"
#include "libalign/warp/warp_fit.h"
#include "rayfield/core/median.h"

namespace rayfield::align {
namespace {

constexpr const char* kCannot = "cannot align the scan";

// Moves every ray of a stream.
class AlignedSource : public RaySource {
 public:
  AlignedSource(RaySource& source, Alignment alignment) : source_(source), alignment_(std::move(alignment)) {}
  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override {
    RAYFIELD_ASSIGN(const std::size_t count, source_.read(batch, max_rays));
    for (std::size_t i = 0; i < count; ++i) {
      batch.origin[i] = alignment_ * batch.origin[i];
      batch.end[i] = alignment_ * batch.end[i];
    }
    return count;
  }
  Result<bool> rewind() override { return source_.rewind(); }
  std::optional<std::uint64_t> ray_count() const override { return source_.ray_count(); }
  std::string name() const override { return source_.name(); }
  std::vector<std::string> warnings() const override { return source_.warnings(); }

 private:
  RaySource& source_;
  Alignment alignment_;
};

tl::unexpected<Error> refuse(const std::string& name, const std::string& why) {
  return fail(ErrorCode::bad_input, kCannot, name, why,
              "check that it shows this block; --no-align adds it where its GPS puts it");
}

// The place of a rival relative to the accepted one, in the frame of the rows.
Rival rival_of(const Hypothesis& best, const Hypothesis& other, const BlockLandmarks& reference) {
  const Eigen::Vector2d along = reference.uprights.front().along;
  const Eigen::Vector2d off = (other.pose.shift - best.pose.shift).head<2>();
  return {off.dot(along), -off.x() * along.y() + off.y() * along.x(),
          std::remainder(other.pose.yaw_rad - best.pose.yaw_rad, 2 * std::numbers::pi),
          best.evidence.log_likelihood() - other.evidence.log_likelihood()};
}

std::string describe(const Rival& rival, const BlockLandmarks& reference) {
  if (std::abs(rival.turn_rad) > std::numbers::pi / 2) return "turned by half a turn";
  const double rows = rival.across_rows_m / reference.row_spacing_m;
  const double panels = rival.along_rows_m / reference.post_spacing_m;
  const auto whole = [](double x) { return std::abs(x) > 0.5 && std::abs(x - std::round(x)) < 0.15; };
  if (whole(rows) && std::abs(rival.along_rows_m) < 0.5) return fmt::format("{:+.0f} rows away", rows);
  if (whole(panels) && std::abs(rival.across_rows_m) < 0.5) return fmt::format("{:+.0f} panels away", panels);
  return fmt::format("{:.1f} m along and {:.1f} m across the rows away", rival.along_rows_m, rival.across_rows_m);
}

// Without the trunks (or posts) that the other side has none of: a survey of posts says nothing of trunks.
BlockLandmarks in_common(const BlockLandmarks& landmarks, const BlockLandmarks& other) {
  BlockLandmarks kept = landmarks;
  for (const bool post : {false, true}) {
    const auto is_kind = [post](const Upright& upright) { return upright.post == post; };
    if (std::none_of(other.uprights.begin(), other.uprights.end(), is_kind)) std::erase_if(kept.uprights, is_kind);
  }
  return kept;
}

// Why the best hypothesis is not believed, taken alone; empty if it is.
std::string doubt(const Evidence& e, const AcceptOptions& accept) {
  if (e.matched < accept.min_landmarks)
    return fmt::format("only {} of its posts and trunks fit those of the block ({} needed)", e.matched,
                       accept.min_landmarks);
  if (e.shared_fraction() < accept.min_shared)
    return fmt::format(
        "only {:.0f} % of the posts and trunks fit, where {:.0f} % are needed: it is another block, or "
        "most of them are hidden",
        100 * e.shared_fraction(), 100 * accept.min_shared);
  if (e.residual_m > accept.max_residual_m)
    return fmt::format("posts and trunks fit to {:.0f} cm only", 100 * e.residual_m);
  if (e.ground.area_m2 > 0 && e.ground.deviation_m > accept.max_ground_m)
    return fmt::format("the ground has another shape (off by {:.2f} m)", e.ground.deviation_m);
  return {};
}

void measure(const LandmarkPair& pair, Alignment& alignment, const std::vector<Match>& matches) {
  std::vector<double> distances;
  double bent = 0;
  for (const Match& m : matches) {
    const Eigen::Vector2d p = pair.scan.uprights[static_cast<std::size_t>(m.scan)].position;
    const Eigen::Vector3d moved = alignment * Eigen::Vector3d(p.x(), p.y(), 0);
    bent += alignment.warp.at(alignment.shift * p).head<2>().squaredNorm() / static_cast<double>(matches.size());
    distances.push_back(
        (moved.head<2>() - pair.reference.uprights[static_cast<std::size_t>(m.reference)].position).norm());
  }
  alignment.landmarks = static_cast<int>(matches.size());
  alignment.warp_rms_m = std::sqrt(bent);
  alignment.residual_m = median_of(distances);
  alignment.residual_rms_m = distances.empty() ? 0 : std::sqrt(trimmed_mean_square(distances));
}

}  // namespace

Eigen::Vector3d Alignment::operator*(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d moved = shift * p;
  return warp.empty() ? moved : Eigen::Vector3d(moved + warp.at(moved.head<2>()));
}

Result<Alignment> align_landmarks(const BlockLandmarks& all_of_reference, const BlockLandmarks& all_of_scan,
                                  const AlignOptions& options, const std::string& name) {
  RAYFIELD_CHECK(options.validate());
  const BlockLandmarks reference = in_common(all_of_reference, all_of_scan);
  const BlockLandmarks scan = in_common(all_of_scan, all_of_reference);
  constexpr std::size_t kMostRivals = 10;
  for (const BlockLandmarks* side : {&reference, &scan})
    if (static_cast<int>(side->uprights.size()) < options.accept.min_landmarks)
      return refuse(name, fmt::format("{} shows {} posts and trunks, {} are needed",
                                      side == &scan ? "it" : "the block's reference", side->uprights.size(),
                                      options.accept.min_landmarks));
  const LandmarkPair pair(reference, scan, options.search.reach_m);
  const std::vector<Hypothesis> hypotheses = find_hypotheses(pair, options.search);
  if (hypotheses.empty())
    return refuse(name, fmt::format("none of its posts and trunks come near those of the block within {:.0f} m",
                                    options.search.max_shift_m));
  const Hypothesis& best = hypotheses.front();
  if (const std::string why = doubt(best.evidence, options.accept); !why.empty()) return refuse(name, why);

  Alignment alignment;
  alignment.shift = best.pose;
  alignment.shared_fraction = best.evidence.shared_fraction();
  alignment.ground_residual_m = best.evidence.ground.deviation_m;
  alignment.margin = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < hypotheses.size() && alignment.rivals.size() < kMostRivals; ++i)
    alignment.rivals.push_back(rival_of(best, hypotheses[i], reference));
  if (!alignment.rivals.empty()) alignment.margin = alignment.rivals.front().log_ratio;
  // The log-likelihood of n matches varies by about √n by chance, at each of the two places.
  const double needed = options.accept.min_margin + 3 * std::sqrt(static_cast<double>(best.evidence.matched));
  if (alignment.margin < needed)
    return refuse(name, fmt::format("two places fit alike: the second is {} (log-likelihood {:.0f} apart, {:.0f} "
                                    "needed)",
                                    describe(alignment.rivals.front(), reference), alignment.margin, needed));
  const std::vector<Match> matches = match_uprights(pair, best.pose, kMatchRadius_m);
  alignment.warp = fit_warp(pair, best.pose, matches, options.warp).warp;
  measure(pair, alignment, matches);
  return alignment;
}

std::unique_ptr<RaySource> open_aligned(RaySource& source, const Alignment& alignment) {
  return std::make_unique<AlignedSource>(source, alignment);
}

}  // namespace rayfield::align
