#include "libalign/pose/hypotheses.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libalign/pose/pose_fit.h"

namespace rayfield::align {
namespace {

constexpr std::size_t kAnchors = 48, kWitnesses = 240;

struct Candidate {
  PlanShift pose;
  double votes = 0;
};

// About `count` indices spread evenly over those of a kind.
std::vector<int> spread(const std::vector<Upright>& uprights, bool posts, std::size_t count) {
  std::vector<int> kind, chosen;
  for (std::size_t i = 0; i < uprights.size(); ++i)
    if (uprights[i].post == posts) kind.push_back(static_cast<int>(i));
  const std::size_t n = std::min(count, kind.size());
  for (std::size_t k = 0; k < n; ++k) chosen.push_back(kind[k * kind.size() / n]);
  return chosen;
}

std::vector<int> spread(const std::vector<Upright>& uprights, std::size_t count) {
  std::vector<int> chosen = spread(uprights, true, count / 2);
  const std::vector<int> trunks = spread(uprights, false, count - chosen.size());
  chosen.insert(chosen.end(), trunks.begin(), trunks.end());
  return chosen;
}

// The turn that lays line `from` along line `to`, nearest to `near_rad`; lines have no sense.
double turn_between(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double near_rad) {
  const double turn = std::atan2(to.y(), to.x()) - std::atan2(from.y(), from.x());
  return near_rad + std::remainder(turn - near_rad, std::numbers::pi);
}

// Witnesses that find a partner. Rows tell the turn to a few milliradians only, so that the tolerance grows with the
// distance from the anchor.
double count_votes(const LandmarkPair& pair, const PlanShift& pose, const Eigen::Vector2d& anchor,
                   const std::vector<int>& witnesses) {
  constexpr double kTolerance = 0.10, kPerMetre = 0.005, kLargest = 0.5, kOtherKind = 0.3;
  double votes = 0;
  for (const int w : witnesses) {
    const Upright& upright = pair.scan.uprights[static_cast<std::size_t>(w)];
    const double distance = (upright.position - anchor).norm();
    const int r = pair.index.nearest(pose * upright.position, std::min(kLargest, kTolerance + kPerMetre * distance));
    if (r >= 0) votes += pair.reference.uprights[static_cast<std::size_t>(r)].post == upright.post ? 1 : kOtherKind;
  }
  return votes;
}

std::vector<Candidate> vote(const LandmarkPair& pair, double near_rad, const SearchOptions& options) {
  const std::vector<int> anchors = spread(pair.scan.uprights, kAnchors);
  const std::vector<int> witnesses = spread(pair.scan.uprights, kWitnesses);
  std::vector<Candidate> candidates;
  for (const int a : anchors) {
    const Upright& anchor = pair.scan.uprights[static_cast<std::size_t>(a)];
    PlanShift turned;
    turned.pivot = pair.pivot;
    turned.yaw_rad = near_rad;
    const double reach = options.max_shift_m + options.max_yaw_rad * (anchor.position - pair.pivot).norm();
    for (const int r : pair.index.within(turned * anchor.position, reach)) {
      const Upright& target = pair.reference.uprights[static_cast<std::size_t>(r)];
      if (target.post != anchor.post) continue;
      Candidate candidate;
      candidate.pose.pivot = pair.pivot;
      candidate.pose.yaw_rad = turn_between(anchor.along, target.along, near_rad);
      if (std::abs(candidate.pose.yaw_rad - near_rad) > options.max_yaw_rad) continue;
      candidate.pose.shift.head<2>() = target.position - candidate.pose * anchor.position;
      if (candidate.pose.shift.head<2>().norm() > options.max_shift_m) continue;
      candidate.votes = count_votes(pair, candidate.pose, anchor.position, witnesses);
      candidates.push_back(candidate);
    }
  }
  return candidates;
}

bool same_place(const PlanShift& a, const PlanShift& b, double distance_m, double turn_rad) {
  return (a.shift - b.shift).head<2>().norm() < distance_m &&
         std::abs(std::remainder(a.yaw_rad - b.yaw_rad, 2 * std::numbers::pi)) < turn_rad;
}

// The best of those near each other, as long as they have a fair share of the most votes.
std::vector<Candidate> distinct_candidates(const std::vector<Candidate>& candidates, int most) {
  constexpr double kApart = 0.4, kTurn = 0.03, kLeastShare = 0.4;  // m, rad
  std::vector<Candidate> chosen;
  for (const Candidate& candidate : candidates) {
    if (static_cast<int>(chosen.size()) >= most || candidate.votes < kLeastShare * candidates.front().votes) break;
    if (std::none_of(chosen.begin(), chosen.end(),
                     [&](const Candidate& other) { return same_place(candidate.pose, other.pose, kApart, kTurn); }))
      chosen.push_back(candidate);
  }
  return chosen;
}

}  // namespace

std::vector<Hypothesis> find_hypotheses(const LandmarkPair& pair, const SearchOptions& options) {
  std::vector<Candidate> candidates = vote(pair, 0, options);
  const std::vector<Candidate> turned = vote(pair, std::numbers::pi, options);
  candidates.insert(candidates.end(), turned.begin(), turned.end());
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.votes > b.votes; });
  std::vector<Hypothesis> hypotheses;
  for (const Candidate& candidate : distinct_candidates(candidates, options.candidates)) {
    Hypothesis hypothesis{fit_pose(pair, candidate.pose), {}};
    hypothesis.evidence = weigh(pair, hypothesis.pose, options);
    hypotheses.push_back(hypothesis);
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(), [](const Hypothesis& a, const Hypothesis& b) {
    return a.evidence.log_likelihood() > b.evidence.log_likelihood();
  });
  std::vector<Hypothesis> distinct;
  for (const Hypothesis& hypothesis : hypotheses)
    if (std::none_of(distinct.begin(), distinct.end(),
                     [&](const Hypothesis& other) { return same_place(hypothesis.pose, other.pose, 0.25, 0.02); }))
      distinct.push_back(hypothesis);
  return distinct;
}

}  // namespace rayfield::align
