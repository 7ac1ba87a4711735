#include "rayfield/core/map_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rayfield {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(LookupProjectedCrs, AcceptsProjectedMetricSystems) {
  for (const char* code : {"EPSG:7854", "EPSG:32633", "EPSG:2154", "EPSG:28354"})
    EXPECT_TRUE(lookup_projected_crs(code)) << code;
}

TEST(LookupProjectedCrs, RefusesGeographicUnknownAndImperialSystemsWithAReason) {
  const auto why = [](const char* code) {
    const auto result = lookup_projected_crs(code);
    EXPECT_FALSE(result) << code;
    if (result) return std::string();
    EXPECT_EQ(result.error().code, ErrorCode::usage);
    return result.error().why;
  };
  EXPECT_NE(why("EPSG:4326").find("geographic"), std::string::npos);
  EXPECT_NE(why("EPSG:999999").find("not know"), std::string::npos);
  EXPECT_NE(why("nonsense").find("not know"), std::string::npos);
  EXPECT_NE(why("").find("not know"), std::string::npos);
  EXPECT_NE(why("EPSG:2272").find("metres"), std::string::npos);  // Pennsylvania South, US survey feet
  EXPECT_NE(why("EPSG:4978").find("geographic"), std::string::npos);
}

// UTM on the central meridian: k0 = 0.9996, false easting 500 km, no convergence (definition of the projection).
TEST(MapFrame, HasTheDefiningConstantsOfUtmOnTheCentralMeridian) {
  const MapFrame frame = MapFrame::create("EPSG:32633").value();
  const Eigen::Vector3d p = frame.map_from_geodetic({47.0, 15.0, 123.0});
  EXPECT_NEAR(p.x(), 500000.0, 1e-6);
  EXPECT_DOUBLE_EQ(p.z(), 123.0);
  EXPECT_NEAR(frame.convergence_rad(p), 0.0, 1e-9);
  EXPECT_NEAR(frame.scale_factor(p), 0.9996, 1e-7);
}

// To first order the convergence of a transverse Mercator projection is Δλ·sin φ, the scale k0·(1 + (ΔE)²/2R²).
TEST(MapFrame, ConvergenceAndScaleFollowTheTransverseMercatorSeries) {
  const MapFrame frame = MapFrame::create("EPSG:7854").value();
  const Eigen::Vector3d llh(-35.2186, 138.5411, 82.0);
  const Eigen::Vector3d p = frame.map_from_geodetic(llh);
  const double delta_lambda = (138.5411 - 141.0) * kDegree;
  EXPECT_NEAR(frame.convergence_rad(p), delta_lambda * std::sin(-35.2186 * kDegree), 2e-5);
  const double delta_e = (p.x() - 500000.0) / 0.9996;
  EXPECT_NEAR(frame.scale_factor(p), 0.9996 * (1 + delta_e * delta_e / (2 * 6.372e6 * 6.372e6)), 2e-6);
}

TEST(MapFrame, GoesToTheMapAndBackWithinMicrometres) {
  const MapFrame frame = MapFrame::create("EPSG:7854").value();
  const Eigen::Vector3d p(276196.5, 6099944.1, 80.0);
  EXPECT_LT((frame.map_from_geodetic(frame.geodetic_from_map(p)) - p).norm(), 1e-5);
}

TEST(TangentPlane, IsMetricEastNorthUpAtItsOrigin) {
  const Eigen::Vector3d origin(-35.0, 138.0, 50.0);
  const TangentPlane plane(origin);
  EXPECT_LT(plane.enu_from_geodetic(origin).norm(), 1e-9);
  EXPECT_NEAR(plane.enu_from_geodetic(origin + Eigen::Vector3d(0, 0, 10)).z(), 10.0, 1e-9);
  // One second of latitude is the meridian radius of curvature times the angle (WGS 84, GRS formula).
  const double e2 = 6.69437999014e-3, a = 6378137.0, s = std::sin(-35.0 * kDegree);
  const double meridian = a * (1 - e2) / std::pow(1 - e2 * s * s, 1.5);
  const Eigen::Vector3d p = plane.enu_from_geodetic(origin + Eigen::Vector3d(1.0 / 3600, 0, 0));
  EXPECT_NEAR(p.y(), (meridian + 50.0) * kDegree / 3600, 1e-3);
  EXPECT_NEAR(p.x(), 0.0, 1e-6);
  EXPECT_LT((plane.enu_from_geodetic(plane.geodetic_from_enu({12, -34, 5})) - Eigen::Vector3d(12, -34, 5)).norm(),
            1e-8);
}

TEST(MapFromEnuJacobian, RotatesByTheConvergenceAndScalesByTheScaleFactor) {
  const MapFrame frame = MapFrame::create("EPSG:7854").value();
  const Eigen::Vector3d llh(-35.2186, 138.5411, 0.0);
  const Eigen::Matrix3d j = map_from_enu_jacobian(frame, TangentPlane(llh), Eigen::Vector3d::Zero());
  const Eigen::Vector3d p = frame.map_from_geodetic(llh);
  EXPECT_NEAR(std::atan2(-j(0, 1), j(1, 1)), frame.convergence_rad(p), 1e-8);
  EXPECT_NEAR(j.col(0).head<2>().norm(), frame.scale_factor(p), 1e-7);
  EXPECT_NEAR(j(2, 2), 1.0, 1e-9);
}

}  // namespace
}  // namespace rayfield
