#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "rayfield/formats/formats.h"
#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// A cloud as it would lie with another GPS offset: turned about its first ray's origin and shifted.
std::string moved_cloud(const std::string& from, const std::string& to, const Eigen::Vector3d& shift, double yaw_rad) {
  auto reader = formats::PlyReader::open(from);
  EXPECT_TRUE(reader);
  auto writer = formats::PlyWriter::create(to, {"EPSG:32632"});
  EXPECT_TRUE(writer);
  RayBatch batch;
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (std::size_t count = 1; count > 0;) {
    const auto read = (*reader)->read(batch, 100000);
    EXPECT_TRUE(read);
    count = read ? *read : 0;
    if (count > 0 && pivot.isZero()) pivot = batch.origin[0];
    for (std::size_t i = 0; i < count; ++i)
      for (Eigen::Vector3d* p : {&batch.origin[i], &batch.end[i]}) *p = turn * (*p - pivot) + pivot + shift;
    if (count > 0) {
      EXPECT_TRUE(writer->write(batch));
    }
  }
  EXPECT_TRUE(writer->close());
  return to;
}

class AlignChain : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    logs_ = new Folder;
    const Outcome run = rayfield({"simulate", small_site(*logs_), "-o", logs_->path("logs"), "-q"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  static void TearDownTestSuite() {
    delete logs_;
    logs_ = nullptr;
  }
  static std::string cloud(const std::string& date) { return logs_->path("logs/" + date + "/rays.ply"); }
  static std::string store_with_first_date(const Folder& work) {
    const std::string store = work.path("block");
    EXPECT_EQ(rayfield({"init", store, "--crs", "EPSG:32632"}).exit_code, 0);
    EXPECT_EQ(rayfield({"add", store, cloud("2021-05-01"), "--date", "2021-05-01", "-q"}).exit_code, 0);
    return store;
  }
  static json alignment_of(const std::string& store, std::size_t scan) {
    return json::parse(rayfield({"status", store, "--json"}).out)["scans"][scan]["alignment"];
  }
  static Folder* logs_;
};
Folder* AlignChain::logs_ = nullptr;

TEST_F(AlignChain, AMovedCloudComesToLieOnTheFirstDate) {
  const Folder work;
  const std::string store = store_with_first_date(work);
  EXPECT_EQ(alignment_of(store, 0)["verdict"], "reference");
  const std::string moved =
      moved_cloud(cloud("2021-07-01"), work.path("moved.ply"), Eigen::Vector3d(1.8, -2.4, 0.9), 0.004);
  const Outcome run = rayfield({"add", store, moved, "--date", "2021-07-01", "--json", "-q"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json alignment = json::parse(run.out)["alignment"];
  EXPECT_EQ(alignment["verdict"], "aligned");
  EXPECT_EQ(alignment_of(store, 1), alignment) << "and is kept";
  EXPECT_NEAR(alignment["yaw_mrad"], -4.0, 2.0);
  // The block's middle is turned with its 14 m rows some 15 m from the pivot: 4 mrad of that are 6 cm.
  EXPECT_NEAR(alignment["offset_e_m"], -1.8, 0.10);
  EXPECT_NEAR(alignment["offset_n_m"], 2.4, 0.10);
  EXPECT_NEAR(alignment["offset_h_m"], -0.9, 0.05);
  EXPECT_LT(alignment["residual_m"], 0.03);
  EXPECT_GE(alignment["landmarks"], 10);

  // What the maps say is what they say of the cloud that was never moved.
  const std::string true_store = work.path("true");
  ASSERT_EQ(rayfield({"init", true_store, "--crs", "EPSG:32632"}).exit_code, 0);
  for (const char* date : {"2021-05-01", "2021-07-01"})
    ASSERT_EQ(rayfield({"add", true_store, cloud(date), "--date", date, "--no-align", "-q"}).exit_code, 0);
  EXPECT_EQ(alignment_of(true_store, 1)["verdict"], "unaligned");
  EXPECT_EQ(alignment_of(true_store, 1)["aligned"], false);
  double areas[2] = {};
  for (const auto& [path, area] : {std::pair{store, &areas[0]}, std::pair{true_store, &areas[1]}}) {
    const Outcome processed = rayfield({"process", path, "--json", "-q"});
    ASSERT_EQ(processed.exit_code, 0) << processed.err;
    *area = json::parse(processed.out)["scans"][1]["plant_area_m2"];
  }
  EXPECT_NEAR(areas[0] / areas[1], 1, 0.02);
}

TEST_F(AlignChain, TheFirstScanOfASurveyedBlockIsLaidOnTheSurvey) {
  const Folder work;
  const std::string found = store_with_first_date(work), survey = work.path("rows.gpkg");
  ASSERT_EQ(rayfield({"process", found, "-q"}).exit_code, 0);
  ASSERT_EQ(rayfield({"registry", "export", found, "-o", survey}).exit_code, 0);
  const std::string moved = moved_cloud(cloud("2021-07-01"), work.path("moved.ply"), Eigen::Vector3d(1.8, -2.4, 0), 0);

  const std::string surveyed = work.path("surveyed");
  ASSERT_EQ(rayfield({"init", surveyed, "--crs", "EPSG:32632", "--reference", survey}).exit_code, 0);
  const Outcome run = rayfield({"add", surveyed, moved, "--date", "2021-07-01", "--json", "-q"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json alignment = json::parse(run.out)["alignment"];
  EXPECT_EQ(alignment["aligned"], true);
  EXPECT_NEAR(alignment["offset_e_m"], -1.8, 0.05);
  EXPECT_NEAR(alignment["offset_n_m"], 2.4, 0.05);
  const Outcome processed = rayfield({"process", surveyed, "--json", "-q"});
  ASSERT_EQ(processed.exit_code, 0) << processed.err;
  EXPECT_EQ(json::parse(processed.out)["panels"],
            json::parse(rayfield({"process", found, "--json", "-q"}).out)["panels"]);
}

TEST_F(AlignChain, WhereTheReferenceIsRemovedAScanThatWasLaidOnItTakesItsPlace) {
  const Folder work;
  const std::string store = store_with_first_date(work);
  const auto add_moved = [&](const std::string& from, const Eigen::Vector3d& shift, const std::string& date,
                             const std::string& align) {
    const std::string path = moved_cloud(cloud(from), work.path(date + ".ply"), shift, 0);
    const Outcome run = rayfield({"add", store, path, "--date", date, align, "--json", "-q"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return json::parse(run.out, nullptr, false)["alignment"];
  };
  // The unaligned scan is the store's first by date, and 1.1 m away from where the block is.
  add_moved("2021-07-01", {0.9, 0.7, 0}, "2021-04-01", "--no-align");
  add_moved("2021-07-01", {1.8, -2.4, 0.9}, "2021-07-01", "--align");
  ASSERT_EQ(rayfield({"remove", store, "2021-05-01", "-q"}).exit_code, 0);
  const json alignment = add_moved("2021-05-01", {-1.2, 1.5, 0.4}, "2021-08-01", "--align");
  EXPECT_EQ(alignment["verdict"], "aligned");
  EXPECT_NEAR(alignment["offset_e_m"], 1.2, 0.05);
  EXPECT_NEAR(alignment["offset_n_m"], -1.5, 0.05);
  EXPECT_NEAR(alignment["offset_h_m"], -0.4, 0.05);
}

TEST_F(AlignChain, AnotherBlockIsRefusedAndTheStoreStaysAsItWas) {
  const Folder work;
  const std::string store = store_with_first_date(work);
  const auto before = content_of(store);
  const std::string far = moved_cloud(cloud("2021-07-01"), work.path("far.ply"), Eigen::Vector3d(80000, 0, 0), 0);
  const std::string turned = moved_cloud(cloud("2021-07-01"), work.path("turned.ply"), Eigen::Vector3d(0, 0, 0), 0.8);
  const Outcome other_rows = rayfield({"add", store, turned, "--date", "2021-07-01", "-q"});
  EXPECT_EQ(other_rows.exit_code, 3);
  EXPECT_EQ(other_rows.error_lines(), 1) << other_rows.err;
  EXPECT_THAT(other_rows.err, HasSubstr("cannot align the scan"));
  EXPECT_THAT(other_rows.err, HasSubstr("--no-align"));
  for (const char* how : {"--align", "--no-align"}) {  // nobody's block is 80 km long
    const Outcome elsewhere = rayfield({"add", store, far, "--date", "2021-07-01", how, "-q"});
    EXPECT_EQ(elsewhere.exit_code, 3);
    EXPECT_EQ(elsewhere.error_lines(), 1) << elsewhere.err;
    EXPECT_THAT(elsewhere.err, HasSubstr("80 km from the scans of the block"));
  }
  EXPECT_EQ(json::parse(rayfield({"status", store, "--json"}).out)["scans"].size(), 1U);
  for (const auto& [path, hash] : before) EXPECT_EQ(content_of(store)[path], hash) << path;
  EXPECT_EQ(rayfield({"add", store, turned, "--date", "2021-07-01", "--no-align", "-q"}).exit_code, 0);
}

}  // namespace
}  // namespace rayfield::test
