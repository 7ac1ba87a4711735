#include "rayfield/core/map_frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

namespace rayfield {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(LookupProjectedCrs, AcceptsProjectedMetricSystems) {
  for (const char* code : {"EPSG:7854", "EPSG:32633", "EPSG:2154", "EPSG:28354"})
    EXPECT_TRUE(lookup_projected_crs(code)) << code;
  for (const char* name : {"WGS 84 / UTM zone 33N", " wgs84 / utm ZONE 33n", "WGS_84_UTM_zone_33N"}) {
    const auto named = lookup_projected_crs(name);
    ASSERT_TRUE(named) << name << named.error().line();
    EXPECT_EQ(named->code, "EPSG:32633");
  }
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
  EXPECT_NE(why("foo").find("not know"), std::string::npos);
  EXPECT_NE(why("").find("not know"), std::string::npos);
  EXPECT_NE(why("EPSG:2272").find("metres"), std::string::npos);  // Pennsylvania South, US survey feet
  EXPECT_NE(why("EPSG:4978").find("geographic"), std::string::npos);
}

TEST(LookupProjectedCrs, ADatabaseThatCannotBeOpenedIsNoFaultOfTheCrs) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit none_left = before;
  none_left.rlim_cur = 3;  // as many as are open always
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none_left), 0);
  const auto result = lookup_projected_crs("EPSG:7854");
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::resources);
  EXPECT_NE(result.error().why.find("proj.db"), std::string::npos) << result.error().why;
}

TEST(LookupProjectedCrs, ADatabaseThatCannotBeReadIsNoFaultOfTheCrs) {
  namespace fs = std::filesystem;
  const fs::path real = "/usr/share/proj/proj.db", folder = fs::temp_directory_path() / "rayfield_proj_test";
  if (!fs::exists(real)) GTEST_SKIP() << "no " << real;
  fs::create_directories(folder);
  fs::copy_file(real, folder / "proj.db", fs::copy_options::overwrite_existing);
  fs::resize_file(folder / "proj.db", 40960);  // its tables are there, their pages are not
  ASSERT_EQ(setenv("PROJ_LIB", folder.c_str(), 1), 0);
  const auto result = lookup_projected_crs("EPSG:7854");
  ASSERT_EQ(unsetenv("PROJ_LIB"), 0);
  fs::remove_all(folder);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::resources) << result.error().line();
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

TEST(UtmCode, CountsZonesOfSixDegreesFromTheAntimeridian) {
  EXPECT_EQ(utm_code(47.3, 8.4), "EPSG:32632");
  EXPECT_EQ(utm_code(-35.2, 138.5), "EPSG:32754");
  EXPECT_EQ(utm_code(0, -180), "EPSG:32601");
  EXPECT_EQ(utm_code(0, 180), "EPSG:32601");
  EXPECT_EQ(utm_code(0, 179.999), "EPSG:32660");
  EXPECT_EQ(utm_code(0, 351.6), utm_code(0, -8.4));
  EXPECT_EQ(utm_code(85, 0), "");
}

TEST(CheckCrsSuits, RefusesSystemsWhoseMetresAreNotThoseOfThePlace) {
  const Eigen::Vector3d place(47.3, 8.4, 400);
  EXPECT_TRUE(check_crs_suits("EPSG:32632", place));
  EXPECT_TRUE(check_crs_suits("EPSG:32631", place)) << "the zone beside it is 0.2 % off at most";
  // Web Mercator stretches by 1/cos(latitude): 1.4746.
  const auto mercator = check_crs_suits("EPSG:3857", place);
  ASSERT_FALSE(mercator);
  EXPECT_THAT(mercator.error().line(), testing::HasSubstr("a metre is 1.47"));
  EXPECT_THAT(mercator.error().next, testing::HasSubstr("EPSG:32632"));
  // Zone 1 is centred on 177° W; from 8.4° E its north lies over the pole.
  const auto far = check_crs_suits("EPSG:32601", place);
  ASSERT_FALSE(far);
  EXPECT_THAT(far.error().line(), testing::HasSubstr("off true north"));
  EXPECT_EQ(check_crs_suits("EPSG:4326", place).error().code, ErrorCode::usage);
}

TEST(SameCrs, HoweverItIsWritten) {
  for (const char* written : {"EPSG:7854", "EPSG:7854 ", " epsg:7854\n", "GDA2020 / MGA zone 54"}) {
    EXPECT_TRUE(same_crs(written, "EPSG:7854")) << written;
    EXPECT_EQ(lookup_projected_crs(written).value().code, "EPSG:7854") << written;
  }
  EXPECT_TRUE(same_crs(lookup_projected_crs("EPSG:7854").value().wkt, "EPSG:7854"));
  EXPECT_FALSE(same_crs("EPSG:7855", "EPSG:7854"));
  EXPECT_FALSE(same_crs("EPSG:28354", "EPSG:7854")) << "another datum";
  EXPECT_FALSE(same_crs("nonsense", "EPSG:7854"));
}

TEST(CheckCrsScale, RefusesWebMercatorBeforeAPlaceIsKnown) {
  for (const char* code : {"EPSG:7854", "EPSG:32632", "EPSG:2154", "EPSG:27700"})
    EXPECT_TRUE(check_crs_scale(code)) << code;
  const auto mercator = check_crs_scale("EPSG:3857");
  ASSERT_FALSE(mercator);
  EXPECT_EQ(mercator.error().code, ErrorCode::usage);
  EXPECT_THAT(mercator.error().line(), testing::HasSubstr("areas would be wrong"));
  for (const char* code : {"EPSG:4326", "EPSG:2225" /* feet */, "nonsense"})
    EXPECT_FALSE(check_crs_scale(code)) << code;
}

TEST(CheckMapPlace, TellsCoordinatesThatAreNoneOfTheCrs) {
  const auto good = check_map_place("EPSG:7854", {276196, 6099944, 80});
  ASSERT_TRUE(good) << good.error().line();
  EXPECT_FALSE(*good);
  // The same place in the zone to the west, 2.6° outside of zone 53.
  const Eigen::Vector3d llh = MapFrame::create("EPSG:7854")->geodetic_from_map({376196, 6099944, 80});
  const auto neighbour = check_map_place("EPSG:7853", MapFrame::create("EPSG:7853")->map_from_geodetic(llh));
  ASSERT_TRUE(neighbour) << neighbour.error().line();
  ASSERT_TRUE(*neighbour);
  EXPECT_THAT(**neighbour, testing::HasSubstr("outside of the area that it is made for"));
  const Eigen::Vector3d wrong[] = {{138.54, -35.22, 80},                     // degrees
                                   {276196 / 0.3048, 6099944 / 0.3048, 80},  // feet
                                   {0, 0, 0},                                // a local frame
                                   {1e8, 1e8, 0}};
  for (const Eigen::Vector3d& p : wrong) {
    const auto place = check_map_place("EPSG:7854", p);
    ASSERT_FALSE(place) << p.transpose();
    EXPECT_EQ(place.error().code, ErrorCode::usage);
  }
  EXPECT_FALSE(check_map_place("EPSG:32632", {8.4, 47.3, 400})) << "degrees, in a zone of the northern hemisphere";
  EXPECT_TRUE(check_map_place("EPSG:2154", {700000, 6600000, 0}));
  const auto mercator = check_map_place("EPSG:3857", {935085, 5987771, 400});
  ASSERT_FALSE(mercator);
  EXPECT_THAT(mercator.error().line(), testing::HasSubstr("a metre is 1.47"));
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
