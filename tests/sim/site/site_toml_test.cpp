#include <gmock/gmock.h>

#include <filesystem>

#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {
namespace {

using ::testing::HasSubstr;

constexpr const char* kDate = "[[date]]\ndate = \"2019-02-11\"\n";

Error error_of(const std::string& text) {
  const auto site = parse_site(text, "SITE.toml");
  if (site) {
    ADD_FAILURE() << "was accepted: " << text;
    return {};
  }
  return site.error();
}

TEST(SiteFile, EveryExampleSiteIsValidAndThereAreAtLeastSeven) {
  int count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(RAYFIELD_SIM_SITES)) {
    if (!entry.is_regular_file()) continue;
    const auto site = read_site(entry.path());
    EXPECT_TRUE(site) << site.error().line();
    ++count;
  }
  EXPECT_GE(count, 7);
}

TEST(SiteFile, ValuesAreReadIntoTheSite) {
  const Site site = take(
      parse_site("[site]\nname = \"x\"\nlatitude_deg = 44\nlongitude_deg = 7\n[rows]\ncount = 5\nspacing_m = 2\n"
                 "[canopy]\nkind = \"sprawl\"\nleaf_angles = \"planophile\"\n[structure]\nwire_heights_m = [0.5, 1]\n"
                 "[surroundings]\nfence = false\n[mount]\nimu_from_spinner = { xyz = [1, 2, 3], q = [0, 0, 0, 1] }\n"
                 "[[date]]\ndate = 2020-01-02\nlanes = [0, 2]\ngps_outages = [{ start_s = 3, duration_s = 4 }]\n"
                 "[[date]]\ndate = \"2020-01-03\"\nleaf_fraction = 0.25\n",
                 "SITE.toml"));
  EXPECT_EQ(site.name, "x");
  EXPECT_EQ(site.crs_code(), "EPSG:32632");
  EXPECT_EQ(site.rows.count, 5);
  EXPECT_EQ(site.rows.spacing_m, 2);
  EXPECT_EQ(site.canopy.kind, CanopyKind::sprawl);
  EXPECT_EQ(site.canopy.leaf_angles, LeafAngles::planophile);
  EXPECT_EQ(site.structure.wire_heights_m, (std::vector<double>{0.5, 1}));
  EXPECT_FALSE(site.surroundings.fence);
  EXPECT_EQ(site.mount.imu_from_spinner.translation, Eigen::Vector3d(1, 2, 3));
  ASSERT_EQ(site.dates.size(), 2U);
  EXPECT_EQ(site.dates[0].date, "2020-01-02");
  EXPECT_EQ(site.dates[0].lanes, (std::vector<int>{0, 2}));
  ASSERT_EQ(site.dates[0].gps_outages.size(), 1U);
  EXPECT_EQ(site.dates[0].gps_outages[0].duration_s, 4);
  EXPECT_EQ(site.dates[1].leaf_fraction, 0.25);
}

TEST(SiteFile, UnknownKeysAreRefusedWithTheirLine) {
  const Error error = error_of(std::string("[rows]\ncount = 3\nspaceing_m = 2.5\n") + kDate);
  EXPECT_EQ(error.code, ErrorCode::usage);
  EXPECT_EQ(error.where, "SITE.toml:3: rows.spaceing_m");
  EXPECT_THAT(error.why, HasSubstr("unknown"));
  EXPECT_EQ(error_of(std::string("[rwos]\n") + kDate).where, "SITE.toml:1: rwos");
  EXPECT_EQ(error_of(std::string(kDate) + "sped = 1\n").where, "SITE.toml:3: date[0].sped");
  EXPECT_EQ(error_of(std::string(kDate) + "gps_outages = [{ begin_s = 1 }]\n").where,
            "SITE.toml:3: date[0].gps_outages[0].begin_s");
}

TEST(SiteFile, WrongTypesAndRangesAreRefusedWithTheirLine) {
  EXPECT_EQ(error_of(std::string("[rows]\ncount = 2.5\n") + kDate).where, "SITE.toml:2: rows.count");
  EXPECT_EQ(error_of(std::string("[rows]\ncount = 0\n") + kDate).where, "SITE.toml:2: rows.count");
  EXPECT_EQ(error_of(std::string("[rows]\nspacing_m = \"wide\"\n") + kDate).where, "SITE.toml:2: rows.spacing_m");
  EXPECT_EQ(error_of(std::string("[terrain]\nslope_percent = nan\n") + kDate).where,
            "SITE.toml:2: terrain.slope_percent");
  EXPECT_EQ(error_of(std::string("rows = 3\n") + kDate).where, "SITE.toml:1: rows");
  EXPECT_THAT(error_of(std::string("[canopy]\nkind = \"hedge\"\n") + kDate).why, HasSubstr("vsp, sprawl, crown"));
  EXPECT_EQ(error_of(std::string("[mount]\nimu_from_lidar = { q = [0, 0, 0, 2] }\n") + kDate).code, ErrorCode::usage);
}

TEST(SiteFile, ContradictionsBetweenKeysAreRefused) {
  EXPECT_EQ(error_of("[site]\nname = \"x\"\n").where, "SITE.toml:1: date");
  EXPECT_EQ(error_of(std::string("[rows]\nlength_m = 26\npanel_length_m = 8.6\n") + kDate).where,
            "SITE.toml:3: rows.panel_length_m");
  EXPECT_EQ(error_of(std::string("[canopy]\nbottom_m = 2\ntop_m = 1.5\n") + kDate).where, "SITE.toml:3: canopy.top_m");
  EXPECT_EQ(error_of(std::string("[rows]\ncurve_radius_m = 5\n") + kDate).where, "SITE.toml:2: rows.curve_radius_m");
  EXPECT_EQ(error_of(std::string("[site]\ncrs = \"EPSG:4326\"\n") + kDate).where, "SITE.toml:2: site.crs");
  EXPECT_EQ(error_of(std::string(kDate) + kDate).where, "SITE.toml:4: date[1].date");
  EXPECT_EQ(error_of("[[date]]\ndate = \"2019-02-30\"\n").where, "SITE.toml:2: date[0].date");
  EXPECT_EQ(error_of(std::string(kDate) + "lanes = [0, 9]\n").where, "SITE.toml:3: date[0].lanes");
  EXPECT_EQ(error_of(std::string(kDate) + "name = \"../x\"\n").where, "SITE.toml:3: date[0].name");
}

TEST(SiteFile, TextThatIsNotTomlAndMissingFilesAreBadInput) {
  const Error error = error_of("[rows\ncount = 3\n");
  EXPECT_EQ(error.code, ErrorCode::bad_input);
  EXPECT_THAT(error.where, HasSubstr("SITE.toml:1"));
  const auto missing = read_site("/no/such/site.toml");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::bad_input);
}

TEST(SiteFile, HugeBlocksAreRefusedBeforeMemoryIsTaken) {
  EXPECT_EQ(error_of(std::string("[rows]\ncount = 500\nlength_m = 2000\n") + kDate).code, ErrorCode::usage);
  EXPECT_EQ(error_of(std::string("[canopy]\nleaf_size_min_cm2 = 1\nleaf_size_max_cm2 = 1\nleaf_area_m2_per_m = 100\n"
                                 "[rows]\nlength_m = 260\ncount = 20\n") +
                     kDate)
                .where,
            "SITE.toml:4: canopy.leaf_area_m2_per_m");
}

}  // namespace
}  // namespace rayfield::sim
