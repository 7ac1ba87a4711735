#include "libslam/solver/residuals.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <random>

#include "libslam/odometry/window.h"

// The hand-written Jacobians against numeric differentiation by Ceres, with the corrections applied to the trajectory
// exactly as the solver does.
namespace rayfield::slam {
namespace {

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

Eigen::VectorXd small_random(int n, unsigned seed, double scale) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> u(-scale, scale);
  Eigen::VectorXd x(n);
  for (double& v : x) v = u(generator);
  return x;
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

// Dense Jacobian of a linearised residual.
template <int Rows>
Eigen::MatrixXd dense(const LinearResidual<Rows>& r, int blocks) {
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(Rows, 6 * blocks);
  for (int k = 0; k < r.blocks; ++k) j.middleCols(6 * r.block[k], 6) += r.jacobian[k];
  return j;
}

struct Functor {
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> f;
  int parameters;
  bool operator()(double const* const* x, double* out) const {
    const Eigen::VectorXd value = f(Eigen::Map<const Eigen::VectorXd>(x[0], parameters));
    std::copy(value.begin(), value.end(), out);
    return true;
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
    PoleVisit v;
    v.time_s = time_s, v.center = center, v.view = view, v.sightings = 3, v.spin_rate_rad_s = 3.1f;
    return v;
  };
  const PoleVisit a = visit(0.33, {2, 1, -1}, {0.9, 0.3, 0}), b = visit(1.47, {1.5, -0.5, -1.2}, {-0.2, -0.9, 0.1});
  constexpr double kDepth = 0.03;
  const Eigen::Vector3d n = Eigen::Vector3d::UnitY();
  const auto r = pole_residual(s.frame, a, b, kDepth, n);
  // The axis, and n as the visit's pose holds it.
  const auto axis = [&](const PoleVisit& v, const Eigen::VectorXd& x) {
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

TEST(BlockSystem, SolvesLikeCeresOnALinearProblemInBothStorages) {
  const int blocks = 5;
  std::vector<LinearResidual<3>> rows;
  for (unsigned k = 0; k < 40; ++k) {
    LinearResidual<3> r;
    r.error = small_random(3, 100 + k, 1);
    for (int b : {static_cast<int>(k) % blocks, static_cast<int>(k * k + 1) % blocks}) {
      const Eigen::VectorXd v = small_random(18, 200 + 7 * k + static_cast<unsigned>(b), 1);
      r.at(b) += Eigen::Map<const Eigen::Matrix<double, 3, 6>>(v.data());
    }
    rows.push_back(r);
  }
  Eigen::MatrixXd stacked(120, 6 * blocks);
  Eigen::VectorXd errors(120);
  for (int k = 0; k < 40; ++k)
    stacked.middleRows(3 * k, 3) = dense(rows[k], blocks), errors.segment<3>(3 * k) = rows[k].error;
  ceres::Problem problem;
  Eigen::VectorXd oracle = Eigen::VectorXd::Zero(6 * blocks);
  auto* cost = new ceres::DynamicNumericDiffCostFunction<Functor>(
      new Functor{[&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return stacked * x + errors; }, 6 * blocks});
  cost->AddParameterBlock(6 * blocks);
  cost->SetNumResiduals(120);
  problem.AddResidualBlock(cost, nullptr, oracle.data());
  ceres::Solver::Options options;
  options.function_tolerance = 1e-16, options.gradient_tolerance = 1e-14, options.parameter_tolerance = 1e-14;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  for (const auto storage : {BlockSystem::Storage::dense, BlockSystem::Storage::sparse}) {
    BlockSystem system(blocks, storage);
    for (const auto& r : rows) system.add(r, 1.0);
    const auto x = system.solve();
    ASSERT_TRUE(x) << x.error().line();
    EXPECT_LT((*x - oracle).cwiseAbs().maxCoeff(), 1e-6);
    const auto covariance = system.marginals({2});
    ASSERT_TRUE(covariance);
    const Eigen::MatrixXd inverse = (stacked.transpose() * stacked).inverse();
    EXPECT_LT(((*covariance)[0] - inverse.block<6, 6>(12, 12)).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(BlockSystem, SolvesIterativelyWhatItSolvesDirectly) {
  // A chain of blocks, each tied to the next, and ties across it like those of revisits.
  const int blocks = 64, extra = blocks - 1;
  BlockSystem whole(blocks, BlockSystem::Storage::sparse), chain = whole, coupling = whole;
  const auto side = [](int first, unsigned seed, double error, int more) {
    SplineResidual r;
    r.error = error, r.first = first, r.extra = more;
    for (unsigned k = 0; k < 4; ++k) r.row[k] = small_random(6, seed + k, 1);
    if (more >= 0) r.extra_row = small_random(6, seed + 4, 1);
    return r;
  };
  for (int b = 0; b < blocks; ++b) {
    const Vector6d offset = small_random(6, 10 + static_cast<unsigned>(b), 1);
    for (BlockSystem* s : {&whole, &chain}) s->add_prior(b, offset, Vector6d::Constant(1e-2));
    for (unsigned k = 0; k < 12 && b + 1 < blocks; ++k) {
      LinearResidual<1> r;
      r.error[0] = 0.3;
      r.at(b) = small_random(6, 1000 * k + static_cast<unsigned>(b), 1).transpose();
      r.at(b + 1) = small_random(6, 5000 * k + static_cast<unsigned>(b), 1).transpose();
      for (BlockSystem* s : {&whole, &chain}) s->add(r, 10);
    }
  }
  for (int k = 0; k < 200; ++k) {
    const int i = (7 * k) % 60, j = (11 * k + 29) % 60;  // in any order; they may overlap
    const double error = 0.01 * k;
    const auto a = side(i, 90000 + 10 * static_cast<unsigned>(k), error, k % 2 == 0 ? extra : -1);
    const auto b = side(j, 95000 + 10 * static_cast<unsigned>(k), error, k % 3 == 0 ? extra : -1);
    LinearResidual<1> r = a.linear();
    const LinearResidual<1> other = b.linear();
    for (int n = 0; n < other.blocks; ++n) r.at(other.block[n]) += other.jacobian[n];
    whole.add(r, 2);
    chain.add(a, 2), chain.add(b, 2), coupling.add_coupling(a, b, 2);
  }
  const auto direct = whole.solve(), iterative = chain.solve(coupling);
  ASSERT_TRUE(direct) << direct.error().line();
  ASSERT_TRUE(iterative) << iterative.error().line();
  EXPECT_LT((*direct - *iterative).norm(), 1e-5 * direct->norm());
}

TEST(BlockSystem, SaysThatASingularSystemIsBadInput) {
  BlockSystem system(2, BlockSystem::Storage::sparse);
  system.add_prior(0, Vector6d::Zero(), Vector6d::Ones());
  system.add_prior(1, Vector6d::Zero(), Vector6d::Zero());
  const auto x = system.solve();
  ASSERT_FALSE(x);
  EXPECT_EQ(x.error().code, ErrorCode::bad_input);
}

}  // namespace
}  // namespace rayfield::slam
