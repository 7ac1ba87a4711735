// SLAM by stage on the synthetic scene of the tests, and one iteration of the window's solve against Ceres with the
// same residuals and Jacobians.
#include <benchmark/benchmark.h>
#include <ceres/ceres.h>

#include "libslam/pipeline/log_odometry.h"
#include "libslam/unwarp/unwarper.h"
#include "rayfield/slam/slam.h"
#include "tests/libslam/synthetic_scene.h"

namespace rayfield::slam {
namespace {

// The messages of a drive, recorded once: making them costs more than some of the stages.
struct Recording : SensorSink {
  std::vector<std::pair<int, std::size_t>> order;
  std::vector<ImuSample> imus;
  std::vector<SpinnerAngle> angles;
  std::vector<GpsFix> fixes;
  std::vector<LidarScan> scans;
  void imu(const ImuSample& s) override { order.emplace_back(0, imus.size()), imus.push_back(s); }
  void spinner(const SpinnerAngle& s) override { order.emplace_back(1, angles.size()), angles.push_back(s); }
  void gps(const GpsFix& s) override { order.emplace_back(2, fixes.size()), fixes.push_back(s); }
  void lidar(const LidarScan& s) override { order.emplace_back(3, scans.size()), scans.push_back(s); }
  void play(SensorSink& sink) const {
    for (const auto& [kind, k] : order) {
      if (kind == 0) sink.imu(imus[k]);
      if (kind == 1) sink.spinner(angles[k]);
      if (kind == 2) sink.gps(fixes[k]);
      if (kind == 3) sink.lidar(scans[k]);
    }
  }
};

const Recording& recording() {
  static const Recording kInstance = [] {
    Recording r;
    testing::feed_scene(r, testing::scene_rig(), {});
    return r;
  }();
  return kInstance;
}

void windowed_stage(benchmark::State& state) {
  Progress progress;
  for (auto _ : state) {
    LogOdometry input(testing::scene_rig(), {}, SlamOptions(), progress);
    recording().play(input);
    benchmark::DoNotOptimize(input.finish());
  }
  state.counters["real_time_factor"] =
      benchmark::Counter(testing::SceneOptions().duration_s, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(windowed_stage)->Unit(benchmark::kMillisecond);

void whole_slam(benchmark::State& state) {
  Progress progress;
  SlamOptions options;
  options.threads = static_cast<int>(state.range(0));
  for (auto _ : state)
    benchmark::DoNotOptimize(run_slam(
        [](SensorSink& sink) -> Result<void> {
          recording().play(sink);
          return {};
        },
        testing::scene_rig(), "", options, progress));
  state.counters["real_time_factor"] =
      benchmark::Counter(testing::SceneOptions().duration_s, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(whole_slam)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void unwarp(benchmark::State& state) {
  Trajectory truth;
  for (int k = 0; k <= 3000; ++k) truth.poses.push_back({testing::kStart + 0.01 * k, testing::scene_pose(0.01 * k, 6)});
  std::size_t rays = 0;
  for (auto _ : state) {
    Unwarper unwarper(testing::scene_rig(), truth, {}, [&](const RayBatch& b) -> Result<void> {
      rays += b.size();
      return {};
    });
    recording().play(unwarper);
    benchmark::DoNotOptimize(unwarper.finish());
  }
  state.counters["rays"] = benchmark::Counter(static_cast<double>(rays), benchmark::Counter::kIsRate);
}
BENCHMARK(unwarp)->Unit(benchmark::kMillisecond);

// A window's system: surfel residuals between random poses, and the gyroscope and accelerometer of five seconds.
struct Window {
  PoseTrack track;
  ResidualFrame frame;
  std::vector<Surfel> surfels;
  std::vector<Eigen::Vector3d> gyro, accel;
  InertialState state;
  std::vector<PairResidual> sides;
  std::vector<LinearResidual<3>> inertial;

  Window() {
    for (int k = 0; k <= 500; ++k) {
      const Rigid3 p = testing::scene_pose(10 + 0.01 * k, 6);
      track.position.push_back(p.translation), track.rotation.push_back(p.rotation);
      const ImuSample s = testing::scene_imu(10 + 0.01 * k, {});
      gyro.push_back(s.angular_velocity_rad_s), accel.push_back(s.linear_acceleration_m_s2);
    }
    frame.track = &track;
    frame.spline = {0.0, 0.2, 25};
    frame.anchor = anchors_of(frame.spline, track);
    frame.extra_block = frame.spline.knots() + 1;
    for (int k = 0; k < 4000; ++k) {
      Surfel s;
      s.time_s = 0.00125 * k;
      s.center =
          Eigen::Vector3f(std::sin(1.7f * static_cast<float>(k)), std::cos(2.3f * static_cast<float>(k)), -1) * 4;
      s.normal = Eigen::Vector3f(std::sin(0.7f * static_cast<float>(k)), std::cos(0.9f * static_cast<float>(k)), 1)
                     .normalized();
      surfels.push_back(s);
    }
    linearise();
  }
  void linearise() {
    sides.clear(), inertial.clear();
    for (std::size_t k = 0; k < 2000; ++k) {
      const PairResidual r = surfel_residual(frame, surfels[k], surfels[k + 2000]);
      sides.push_back(r);
    }
    const BiasWeights bias{{frame.spline.knots(), frame.spline.knots()}, {1, 0}};
    for (int k = 1; k + 5 < 500; k += 5) {
      inertial.push_back(gyro_residual(frame, bias, state, gyro, k, 5));
      inertial.push_back(accel_residual(frame, bias, state, accel, k, 5));
    }
  }
};

void one_step_dense(benchmark::State& state) {
  Window w;
  for (auto _ : state) {
    w.linearise();
    BlockSystem system(w.frame.extra_block + 1, BlockSystem::Storage::dense);
    for (const PairResidual& r : w.sides)
      system.add(r.first, 1e3), system.add(r.second, 1e3), system.add_coupling(r.first, r.second, 1e3);
    for (const auto& r : w.inertial) system.add(r, 1e3);
    for (int b = 0; b <= w.frame.extra_block; ++b) system.add_prior(b, Vector6d::Zero(), Vector6d::Constant(1));
    benchmark::DoNotOptimize(system.solve());
  }
}
BENCHMARK(one_step_dense)->Unit(benchmark::kMillisecond);

// The same residual as a cost function over the blocks it touches.
template <int Rows>
class Linear : public ceres::CostFunction {
 public:
  Linear(const LinearResidual<Rows>& r, double root) : r_(r), root_(root) {
    set_num_residuals(Rows);
    for (int k = 0; k < r.blocks; ++k) mutable_parameter_block_sizes()->push_back(6);
  }
  bool Evaluate(double const* const* x, double* residual, double** jacobians) const override {
    Eigen::Map<Eigen::Matrix<double, Rows, 1>> e(residual);
    e = root_ * r_.error;
    for (int k = 0; k < r_.blocks; ++k) {
      e += root_ * r_.jacobian[k] * Eigen::Map<const Vector6d>(x[k]);
      if (jacobians == nullptr || jacobians[k] == nullptr) continue;
      for (int row = 0; row < Rows; ++row)
        for (int column = 0; column < 6; ++column) jacobians[k][6 * row + column] = root_ * r_.jacobian[k](row, column);
    }
    return true;
  }

 private:
  const LinearResidual<Rows>& r_;
  double root_;
};

void one_step_ceres(benchmark::State& state) {
  Window w;
  for (auto _ : state) {
    w.linearise();
    std::vector<Vector6d> x(static_cast<std::size_t>(w.frame.extra_block) + 1, Vector6d::Zero());
    ceres::Problem problem;
    const auto add = [&](const auto& r) {
      constexpr int kRows = std::decay_t<decltype(r.error)>::RowsAtCompileTime;
      std::vector<double*> blocks;
      for (int k = 0; k < r.blocks; ++k) blocks.push_back(x[static_cast<std::size_t>(r.block[k])].data());
      problem.AddResidualBlock(new Linear<kRows>(r, std::sqrt(1e3)), nullptr, blocks);
    };
    std::vector<LinearResidual<1>> matches;  // as Ceres wants them: both sides in one
    for (const PairResidual& s : w.sides) {
      matches.push_back(s.first.linear());
      const LinearResidual<1> second = s.second.linear();
      for (int k = 0; k < second.blocks; ++k) matches.back().at(second.block[k]) += second.jacobian[k];
    }
    for (const auto& r : matches) add(r);
    for (const auto& r : w.inertial) add(r);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.max_num_iterations = 1;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    benchmark::DoNotOptimize(x);
  }
}
BENCHMARK(one_step_ceres)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rayfield::slam
