#include "libslam/solver/residuals.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include "tests/libslam/linear_residuals.h"

// The hand-written Jacobians against numeric differentiation by Ceres, with the corrections applied to the trajectory
// exactly as the solver does.
namespace rayfield::slam {
namespace {

using testing::dense;
using testing::Functor;

constexpr double kStep = 0.01;

// A bumpy, turning track of two seconds.
PoseTrack bumpy_track() {
  PoseTrack t;
  t.step_s = kStep;
  for (int k = 0; k <= 200; ++k) {
    const double s = k * kStep;
    t.position.emplace_back(1.5 * s, 0.3 * std::sin(2 * s), 0.02 * std::sin(11 * s));
    t.rotation.push_back(exp_so3(Eigen::Vector3d(0.05 * std::sin(5 * s), 0.04 * std::cos(4 * s), 0.8 * s)));
  }
  return t;
}

struct TwoPoses {
  PoseTrack track = bumpy_track();
  ResidualFrame frame;
  int bias_block, blocks;
  std::vector<Eigen::Vector3d> accel, gyro;
  InertialState state;

  TwoPoses() {
    frame.track = &track;
    frame.spline = {0.0, 0.2, 10};
    frame.anchor = anchors_of(frame.spline, track);
    bias_block = frame.spline.knots();
    frame.extra_block = bias_block + 1;
    blocks = bias_block + 2;
    frame.spin_axis = Eigen::Vector3d(0.01, -0.02, 1).normalized();
    frame.spin_origin = Eigen::Vector3d(0.1, 0, 0.2);
    for (int k = 0; k <= 200; ++k) {
      const double s = k * kStep;
      accel.emplace_back(0.3 * std::sin(7 * s), -0.2, 9.8 + std::cos(9 * s));
      gyro.emplace_back(0.1 * std::cos(5 * s), -0.1 * std::sin(4 * s), 0.8);
    }
    state.gyro_bias = Eigen::Vector3d(0.01, -0.02, 0.005);
    state.accel_bias = Eigen::Vector3d(0.05, 0.02, -0.03);
    state.gravity = Eigen::Vector3d(0.05, -0.04, 9.8);
  }

  // The track after corrections x (six per block).
  PoseTrack corrected(const Eigen::VectorXd& x) const {
    PoseTrack t = track;
    apply_correction(frame, x, 0, t.size() - 1, t);
    return t;
  }
  InertialState moved(const Eigen::VectorXd& x) const {
    InertialState s = state;
    s.gyro_bias += x.segment<3>(6 * bias_block);
    s.accel_bias += x.segment<3>(6 * bias_block + 3);
    const double length = s.gravity.norm();
    s.gravity.head<2>() += x.segment<2>(6 * (bias_block + 1));
    s.gravity.z() = std::sqrt(length * length - s.gravity.head<2>().squaredNorm());
    return s;
  }
};

// Ridders' method of Ceres: accurate to about 1e-9 of the scale of the function.
Eigen::MatrixXd numeric(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& f, int rows, int parameters) {
  ceres::NumericDiffOptions options;
  options.ridders_relative_initial_step_size = 1e-3;
  auto* cost = new ceres::DynamicNumericDiffCostFunction<Functor, ceres::RIDDERS>(new Functor{f, parameters},
                                                                                  ceres::TAKE_OWNERSHIP, options);
  cost->AddParameterBlock(parameters);
  cost->SetNumResiduals(rows);
  const std::unique_ptr<ceres::CostFunction> owner(cost);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(parameters);
  const double* x[1] = {zero.data()};
  Eigen::VectorXd value(rows);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> j(rows, parameters);
  double* jacobians[1] = {j.data()};
  EXPECT_TRUE(owner->Evaluate(x, value.data(), jacobians));
  return j;
}

TEST(GyroResidual, HasTheDerivativeThatDifferencesGive) {
  const TwoPoses s;
  const BiasWeights bias{{s.bias_block, s.bias_block}, {1, 0}};
  const auto r = gyro_residual(s.frame, bias, s.state, s.gyro, 63, 5);
  const auto f = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    const PoseTrack t = s.corrected(x);
    ResidualFrame frame = s.frame;
    frame.track = &t;
    return gyro_residual(frame, bias, s.moved(x), s.gyro, 63, 5).error;
  };
  EXPECT_LT((dense(r, s.blocks) - numeric(f, 3, 6 * s.blocks)).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(AccelResidual, HasTheDerivativeThatDifferencesGive) {
  const TwoPoses s;
  const BiasWeights bias{{s.bias_block, s.bias_block}, {1, 0}};
  const auto r = accel_residual(s.frame, bias, s.state, s.accel, 63, 5);
  const auto f = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    const PoseTrack t = s.corrected(x);
    ResidualFrame frame = s.frame;
    frame.track = &t;
    return accel_residual(frame, bias, s.moved(x), s.accel, 63, 5).error;
  };
  EXPECT_LT((dense(r, s.blocks) - numeric(f, 3, 6 * s.blocks)).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(GpsResidual, HasTheDerivativeThatDifferencesGive) {
  const TwoPoses s;
  const Eigen::Vector3d arm(-0.4, 0.1, 0.5), fix(1, 2, 3);
  const auto r = gps_residual(s.frame, 0.73, arm, fix);
  const auto f = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    const PoseTrack t = s.corrected(x);
    ResidualFrame frame = s.frame;
    frame.track = &t;
    return gps_residual(frame, 0.73, arm, fix).error;
  };
  EXPECT_LT((dense(r, s.blocks) - numeric(f, 3, 6 * s.blocks)).cwiseAbs().maxCoeff(), 1e-5);
}

Surfel surfel_at(double time, const Eigen::Vector3f& center, const Eigen::Vector3f& normal) {
  Surfel out;
  out.time_s = time;
  out.center = center;
  out.normal = normal.normalized();
  out.spin_rate_rad_s = 3.1f;
  return out;
}

// A surfel in the world after the corrections x. The extra unknowns: it moves to its new time, turned by what the
// spinner did meanwhile. Derivatives of a pose between grid times exist on either side only, so time moves along the
// tangent.
struct Placed {
  Eigen::Vector3d center, normal;
};
Placed place(const TwoPoses& s, double time_s, const Placed& body, double spin_rate_rad_s, const Eigen::VectorXd& x) {
  const double lidar = x[6 * s.frame.extra_block + 2], angle = x[6 * s.frame.extra_block + 3];
  const Eigen::Quaterniond turn = exp_so3((angle + lidar * spin_rate_rad_s) * s.frame.spin_axis);
  const Eigen::Vector3d c = turn * (body.center - s.frame.spin_origin) + s.frame.spin_origin;
  const SplineWeights w = s.frame.spline.weights(time_s);
  Rigid3 pose = s.track.pose(time_s);
  Eigen::Vector3d move = Eigen::Vector3d::Zero(), by = move;
  for (int j = 0; j < 4; ++j) {
    const Vector6d d = x.segment<6>(6 * (w.first + j));
    const Eigen::Vector3d lever = pose.translation - s.frame.anchor[static_cast<std::size_t>(w.first + j)];
    move += w.value[j] * (d.head<3>() + d.tail<3>().cross(lever));
    by += w.value[j] * d.tail<3>();
  }
  pose.translation += move + lidar * s.track.velocity(time_s);
  pose.rotation = exp_so3(by + lidar * s.track.angular_velocity(time_s)) * pose.rotation;
  return {pose * c, pose.rotation * (turn * body.normal)};
}
Placed place(const TwoPoses& s, const Surfel& q, const Eigen::VectorXd& x) {
  const Placed body{q.center.cast<double>(), q.normal.cast<double>()};
  return place(s, q.time_s, body, static_cast<double>(q.spin_rate_rad_s), x);
}

TEST(SurfelResidual, HasTheDerivativeThatDifferencesGive) {
  const TwoPoses s;
  const Surfel a = surfel_at(0.33, {2, 1, -1}, {-1, -0.3f, 0.2f}),
               b = surfel_at(1.47, {1.5f, -0.5f, -1.2f}, {-1, 0.2f, 0.1f});
  const auto r = surfel_residual(s.frame, a, b);
  const auto f = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    const Placed pa = place(s, a, x), pb = place(s, b, x);
    return Eigen::Matrix<double, 1, 1>((pb.center - pa.center).dot((pa.normal + pb.normal).normalized()));
  };
  const Eigen::MatrixXd both = dense(r.first.linear(), s.blocks) + dense(r.second.linear(), s.blocks);
  EXPECT_NEAR(r.error(), f(Eigen::VectorXd::Zero(6 * s.blocks))[0], 1e-9);
  EXPECT_LT((both - numeric(f, 1, 6 * s.blocks)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(SurfelResidual, DoesNotChangeWhenTheWholeDriveIsTurned) {
  const TwoPoses s;
  const Surfel a = surfel_at(0.33, {2, 1, -1}, {-1, -0.3f, 0.2f}),
               b = surfel_at(1.47, {1.5f, -0.5f, -1.2f}, {-1, 0.2f, 0.1f});
  const auto r = surfel_residual(s.frame, a, b);
  const Eigen::MatrixXd both = dense(r.first.linear(), s.blocks) + dense(r.second.linear(), s.blocks);
  const Eigen::Vector3d turn(0.3, -0.2, 0.5), about(4, 5, 6);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(6 * s.blocks);
  for (int j = 0; j < s.frame.spline.knots(); ++j)
    x.segment<6>(6 * j) << turn.cross(s.frame.anchor[static_cast<std::size_t>(j)] - about), turn;
  EXPECT_NEAR((both * x)[0], 0, 1e-12);
}

TEST(PoleResidual, HasTheDerivativeThatDifferencesGive) {
  const TwoPoses s;
  const auto visit = [](double time_s, const Eigen::Vector3d& center, const Eigen::Vector3d& view) {
    PoleObservation v;
    v.time_s = time_s, v.center = center, v.view = view, v.detections = 3, v.spin_rate_rad_s = 3.1f;
    return v;
  };
  const PoleObservation a = visit(0.33, {2, 1, -1}, {0.9, 0.3, 0}),
                        b = visit(1.47, {1.5, -0.5, -1.2}, {-0.2, -0.9, 0.1});
  constexpr double kDepth = 0.03;
  const Eigen::Vector3d n = Eigen::Vector3d::UnitY();
  const auto r = pole_residual(s.frame, a, b, kDepth, n);
  // The axis, and n as the visit's pose holds it.
  const auto axis = [&](const PoleObservation& v, const Eigen::VectorXd& x) {
    const double depth = kDepth + x[6 * s.frame.extra_block + kPoleDepth];
    const Placed body{v.center + depth * v.view, s.track.pose(v.time_s).rotation.conjugate() * n};
    return place(s, v.time_s, body, static_cast<double>(v.spin_rate_rad_s), x);
  };
  const auto f = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    const Placed pa = axis(a, x), pb = axis(b, x);
    return Eigen::Matrix<double, 1, 1>((pb.center - pa.center).dot((pa.normal + pb.normal).normalized()));
  };
  const Eigen::MatrixXd both = dense(r.first.linear(), s.blocks) + dense(r.second.linear(), s.blocks);
  EXPECT_NEAR(r.error(), f(Eigen::VectorXd::Zero(6 * s.blocks))[0], 1e-9);
  EXPECT_LT((both - numeric(f, 1, 6 * s.blocks)).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace rayfield::slam
