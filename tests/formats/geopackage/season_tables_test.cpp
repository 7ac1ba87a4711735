#include "rayfield/formats/season_tables.h"

#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <set>
#include <string>

#include "tests/formats/gdal_dataset.h"
#include "tests/formats/season_support.h"

namespace rayfield::formats {
namespace {

using testing::expect_valid_geopackage;
using testing::make_block;
using testing::make_comparison;
using testing::make_season;
using testing::message;
using testing::read_file;
using testing::TemporaryFolder;

TEST(ChangeGeoPackage, HoldsEveryPanelWithItsChangeAndPassesTheValidator) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(2, 4, {"2019-01-11", "2019-02-11"});
  const DateComparison c = make_comparison(block);
  const std::string path = folder / "c.gpkg";
  const auto written = write_change_geopackage(block, c, path);
  ASSERT_TRUE(written) << message(written);
  expect_valid_geopackage(path);

  const auto dataset = testing::open_dataset(path, GDAL_OF_VECTOR);
  ASSERT_NE(dataset, nullptr);
  OGRLayer* layer = dataset->GetLayerByName("panel_change");
  ASSERT_NE(layer, nullptr);
  EXPECT_EQ(layer->GetFeatureCount(), 8);
  std::set<std::string> verdicts;
  for (const auto& feature : layer) {
    const std::string verdict = feature->GetFieldAsString("significance");
    verdicts.insert(verdict);
    EXPECT_STREQ(feature->GetFieldAsString("date_a"), "2019/01/11");
    EXPECT_STREQ(feature->GetFieldAsString("date_b"), "2019/02/11");
    ASSERT_NE(feature->GetGeometryRef(), nullptr);
    const int change = layer->GetLayerDefn()->GetFieldIndex("leaf_change_m2");
    EXPECT_EQ(feature->IsFieldNull(change) != 0, verdict == "not_seen");
    if (verdict != "not_seen") {
      EXPECT_EQ(feature->GetFieldAsDouble(change), 0.8125);
    }
  }
  EXPECT_EQ(verdicts, (std::set<std::string>{"gain", "loss", "none", "not_seen"}));
  OGRLayer* described = dataset->ExecuteSQL(
      "SELECT count(*) FROM gpkg_data_columns WHERE table_name = 'panel_change' AND description <> ''", nullptr,
      nullptr);
  ASSERT_NE(described, nullptr);
  const OGRFeatureUniquePtr count(described->GetNextFeature());
  EXPECT_EQ(count->GetFieldAsInteger(0), layer->GetLayerDefn()->GetFieldCount()) << "a column without a description";
  dataset->ReleaseResultSet(described);
  EXPECT_NE(dataset->GetLayerByName("layer_styles"), nullptr);
}

TEST(ChangeGeoPackage, EqualInputGivesEqualBytesAndBadInputIsRefused) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(2, 4, {"2019-01-11", "2019-02-11"});
  DateComparison c = make_comparison(block);
  ASSERT_TRUE(write_change_geopackage(block, c, folder / "a.gpkg"));
  ASSERT_TRUE(write_change_geopackage(block, c, folder / "b.gpkg"));
  EXPECT_TRUE(read_file(folder / "a.gpkg") == read_file(folder / "b.gpkg"));
  EXPECT_EQ(write_change_geopackage(block, c, folder / "none/c.gpkg").error().code, ErrorCode::bad_input);
  c.b.scan_date = "2019-02-30";
  EXPECT_EQ(write_change_geopackage(block, c, folder / "c.gpkg").error().code, ErrorCode::usage);
}

TEST(ChangeCsv, HasOneLinePerPanelWithEmptyFieldsWhereNothingWasSeen) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(1, 4, {"2019-01-11", "2019-02-11"});
  ASSERT_TRUE(write_change_csv(make_comparison(block), folder / "c.csv"));
  const std::string text = read_file(folder / "c.csv");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5);
  EXPECT_EQ(text.substr(0, text.find('\n')),
            "panel_uid,row_number,panel_number,length_m,scan_a,date_a,scan_b,date_b,significance,leaf_area_a_m2,"
            "leaf_area_b_m2,leaf_change_m2,leaf_change_per_m,leaf_change_percent,se_change_m2,ci_low_m2,ci_high_m2,"
            "p_value,plant_area_a_m2,plant_area_b_m2,plant_change_m2");
  EXPECT_NE(text.find("panel-1-1,1,1,6.5,scan-2019-01-11,2019-01-11,scan-2019-02-11,2019-02-11,gain,11.375,12.1875,"
                      "0.8125,0.125,12.5,0.25,0.3225,1.3025,0.0012,13.375,14.1875,0.75\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("not_seen,21.125,,,,,,,,,23.125,,\n"), std::string::npos) << text;
}

TEST(SeasonCsv, HasTheBlockFirstWithoutARowNumber) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(2, 2, {"2019-01-11", "2019-02-11"});
  ASSERT_TRUE(write_season_csv(make_season(block), folder / "s.csv"));
  const std::string text = read_file(folder / "s.csv");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 7);
  EXPECT_NE(text.find("\n,scan-2019-01-11,2019-01-11,2,2,13,19.5,1.5,1.4,1.6,21.5,"), std::string::npos) << text;
  EXPECT_NE(text.find("\n2,scan-2019-02-11,2019-02-11,2,1,13,39,3,2.9,3.1,41,"), std::string::npos) << text;
}

}  // namespace
}  // namespace rayfield::formats
