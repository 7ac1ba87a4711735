#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "rayfield/core/option_fields.h"
#include "rayfield/core/ray_source.h"
#include "rayfield/density/horizon_misses.h"

/// ray_filters: rays put right on their way into the store: those without a return that clouds leave out.
namespace rayfield::density {

/// Which gaps between beams are taken for rays without a return.
struct MissingRayOptions {
  double lowest_elevation_rad = -0.26;
  int longest_gap = 64;
  int most_above = 2;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("lowest_elevation_rad", o.lowest_elevation_rad, {-1.5, 0},
             "Gaps that reach further below the horizon (-15°) stay open: there the ground sends rays back, and the "
             "vehicle stopped them");
    v.integer("longest_gap", o.longest_gap, {1, 1000}, "Beams in a row that may be missing");
    v.integer("most_above", o.most_above, {0, 1000},
              "Beams above the horizon in a gap; with more, it is not for want of a return");
  }
  Result<void> validate() const;
};

/// Puts back what ray clouds leave out: downward rays that came back from nowhere.
///
/// Such rays are dropped when a cloud is made, since their length is unknown, while downward rays that a leaf stopped
/// are kept. So near the horizon, and below it where the ground falls away, a canopy loses the rays that pass through
/// it and looks denser than it is (6 % on an 8 % slope; docs/density.md). A lidar sends its beams at a steady rate in
/// steady steps of angle, so the gaps show: where the times of two successive rays are k beam periods apart and their
/// directions k steps, the k − 1 rays between them are interpolated. Those that point down, but not steeply, become
/// rays without a hit, as long as the longest other ray without one. Gaps that go on above the horizon or steeply
/// down are something else (a part of the vehicle) and stay open.
///
/// The beam period is the median step of time over the first rays. A stream whose times do not tell beams apart
/// (equal stamps, several beams at a time, shuffled rays, merged clouds) is passed on as it is, with a warning unless
/// it holds its downward rays without a return.
class MissingRaySource : public RaySource {
 public:
  /// `source` must outlive this object. Errors: usage.
  static Result<std::unique_ptr<MissingRaySource>> create(RaySource& source, const MissingRayOptions& options);

  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override;
  Result<bool> rewind() override;
  std::string name() const override { return source_.name(); }
  std::vector<std::string> warnings() const override;

  std::uint64_t restored() const { return restored_; }

 private:
  MissingRaySource(RaySource& source, const MissingRayOptions& options) : source_(source), options_(options) {}
  Result<void> refill();
  void study_times();
  void process(std::size_t i);
  struct Last {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero(), direction = Eigen::Vector3d::Zero();
    double time_s = 0, step_rad = 0;  ///< step: angle to its own predecessor, one period before; 0 = unknown
    bool valid = false;
  };
  /// The rays in the gap of `periods` beam periods and `angle` radians between the last ray and this one.
  void restore(const Last& now, double angle, int periods);

  RaySource& source_;
  MissingRayOptions options_;
  RayBatch in_, out_;  ///< read ahead, and what waits to be handed on
  std::size_t out_at_ = 0;
  bool studied_ = false, usable_ = false, ended_ = false;
  double period_s_ = 0, longest_m_ = 0;
  std::uint64_t restored_ = 0;
  HorizonMisses misses_;  ///< of a stream that is passed on as it is
  Last last_;
};

}  // namespace rayfield::density
