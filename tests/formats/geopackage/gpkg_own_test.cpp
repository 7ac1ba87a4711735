#include "formats/geopackage/gpkg_own.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <fstream>

#include "rayfield/formats/geopackage.h"
#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

using testing::expect_valid_geopackage;
using ::testing::HasSubstr;
using testing::make_block;
using testing::message;
using testing::TemporaryFolder;

const std::vector<std::string> kTwoDates = {"2018-12-12", "2019-02-11"};
const std::vector<std::string> kScanIds = {"scan-2018-12-12", "scan-2019-02-11"};  // that the store holds

// Runs SQL on a file, as a user would with sqlite3 or QGIS's database manager.
void change(const std::string& path, const std::vector<std::string>& statements) {
  GDALAllRegister();
  GDALDataset* dataset = GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE);
  ASSERT_NE(dataset, nullptr);
  for (const std::string& sql : statements)
    dataset->ReleaseResultSet(dataset->ExecuteSQL(sql.c_str(), nullptr, nullptr));
  GDALClose(dataset);
}

TEST(GeoPackageOfUsers, SaysWhichSnapshotItIsOfAndWhatIsItsOwn) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(2, 3, kTwoDates);
  block.snapshot = 42;
  ASSERT_TRUE(write_geopackage(block, folder / "a.gpkg"));
  expect_valid_geopackage(folder / "a.gpkg");
  GDALDataset* dataset = GDALDataset::Open((folder / "a.gpkg").c_str(), GDAL_OF_VECTOR);
  EXPECT_STREQ(dataset->GetMetadataItem("snapshot"), "42");
  EXPECT_THAT(dataset->GetMetadataItem("rayfield_tables"), HasSubstr("panel(fid,geom,panel_uid,"));
  GDALClose(dataset);
  const auto existing = inspect_geopackage(folder / "a.gpkg");
  ASSERT_TRUE(existing && *existing);
  EXPECT_THAT((*existing)->lost, ::testing::IsEmpty());
  EXPECT_FALSE((*existing)->has_additions);
  EXPECT_THAT((*existing)->scan_ids, ::testing::ElementsAre("scan-2018-12-12", "scan-2019-02-11"));
  EXPECT_FALSE(*inspect_geopackage(folder / "absent.gpkg"));
}

TEST(GeoPackageOfUsers, IsNotReplacedByOneThatLacksItsScans) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.gpkg";
  const BlockProducts both = make_block(2, 3, kTwoDates), one = make_block(2, 3, {"2019-02-11"});
  EXPECT_TRUE(check_replaceable(one, kScanIds, path)) << "nothing is there";
  ASSERT_TRUE(write_geopackage(one, path));
  EXPECT_TRUE(check_replaceable(one, kScanIds, path));
  EXPECT_TRUE(check_replaceable(both, kScanIds, path)) << "another date is added";
  ASSERT_TRUE(write_geopackage(both, path));
  const auto refused = check_replaceable(one, kScanIds, path);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_THAT(refused.error().line(), HasSubstr("scan-2018-12-12"));
  EXPECT_THAT(refused.error().line(), HasSubstr("--overwrite"));
  EXPECT_TRUE(check_replaceable(one, {"scan-2019-02-11"}, path)) << "the store has lost the other scan since";
}

TEST(GeoPackageOfUsers, AColumnInATableOfOursIsNotReplaced) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(2, 3, kTwoDates);
  const std::string path = folder / "a.gpkg";
  ASSERT_TRUE(write_geopackage(block, path));
  change(path, {"ANALYZE", "UPDATE panel SET length_m = 1"});
  EXPECT_TRUE(check_replaceable(block, kScanIds, path)) << "values of ours are not looked at";
  change(path, {"ALTER TABLE panel ADD COLUMN note TEXT"});
  const auto refused = check_replaceable(block, kScanIds, path);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_THAT(refused.error().line(), HasSubstr("column 'note' of table 'panel'"));
}

TEST(GeoPackageOfUsers, AFileThatAnotherProgramWritesToIsNotReplaced) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(1, 1, kTwoDates);
  ASSERT_TRUE(write_geopackage(block, folder / "a.gpkg"));
  std::ofstream(folder / "a.gpkg-wal").flush();
  EXPECT_TRUE(check_replaceable(block, kScanIds, folder / "a.gpkg")) << "an empty journal holds nothing";
  std::ofstream(folder / "a.gpkg-wal") << "pages";
  const auto refused = check_replaceable(block, kScanIds, folder / "a.gpkg");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().line(), HasSubstr("a.gpkg-wal"));
}

TEST(GeoPackageOfUsers, AFileFromBeforeTablesWereRecordedIsStillKnown) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(2, 3, kTwoDates);
  const std::string path = folder / "a.gpkg";
  ASSERT_TRUE(write_geopackage(block, path));
  const std::vector<std::string> forget = {"DELETE FROM gpkg_metadata_reference", "DELETE FROM gpkg_metadata"};
  change(path, forget);
  EXPECT_TRUE(check_replaceable(block, kScanIds, path)) << message(check_replaceable(block, kScanIds, path));
  change(path, {"ALTER TABLE panel ADD COLUMN note TEXT"});
  EXPECT_FALSE(check_replaceable(block, kScanIds, path));
}

TEST(GeoPackageOfUsers, AFileOfAnotherProgramIsNotReplaced) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(1, 1, kTwoDates);
  GDALAllRegister();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  GDALDataset* dataset = driver->Create((folder / "a.gpkg").c_str(), 0, 0, 0, GDT_Unknown, nullptr);
  dataset->CreateLayer("scan", nullptr, wkbPoint, nullptr);
  GDALClose(dataset);
  std::ofstream(folder / "b.gpkg") << "no GeoPackage";
  for (const char* name : {"a.gpkg", "b.gpkg"}) {
    const auto refused = check_replaceable(block, kScanIds, folder / name);
    ASSERT_FALSE(refused) << name;
    EXPECT_THAT(refused.error().line(), HasSubstr("rayfield has not written"));
  }
}

}  // namespace
}  // namespace rayfield::formats
