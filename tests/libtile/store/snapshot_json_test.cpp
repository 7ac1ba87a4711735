#include "libtile/store/snapshot_json.h"

#include <gtest/gtest.h>

namespace rayfield::tile::testing {
namespace {

Snapshot sample_snapshot() {
  Snapshot snapshot;
  snapshot.number = 7;
  snapshot.parent = 6;
  snapshot.created_utc = "2019-02-11T00:00:00.000Z";
  snapshot.software_version = "0.1.0";
  snapshot.command = "rayfield add \"x\"";
  ScanEntry scan;
  scan.scan_id = "2019-02-11_veraison";
  scan.date = "2019-02-11";
  scan.name = "véraison";
  scan.inputs = {{"a.ply", 1234567890123, "ab"}};
  scan.ray_count = 10;
  scan.hit_count = 4;
  scan.start_time_s = 1549843200.123456;
  scan.end_time_s = 1549843201.1;
  scan.origin_bounds.extend(Eigen::Vector3d(1.1, 2.2, 3.3));
  scan.warnings = {"3 rays dropped"};
  TileEntry tile;
  tile.index = {-3, 7};
  tile.file = {"scans/x/rays/a.h5", 5, "cd"};
  tile.more_files = {{"scans/x/rays/b.h5", 6, "ef"}};
  tile.segment_count = 9, tile.start_count = 8, tile.hit_count = 3;
  tile.bounds.extend(Eigen::Vector3d(0.1, 0.2, 0.3));
  tile.bounds.extend(Eigen::Vector3d(1, 2, 3));
  scan.tiles = {tile};
  scan.derived = {{"ground", "block", "key", {"scans/x/ground/c.h5", 1, "01"}}};
  scan.attachments = {{"slam.json", {"scans/x/files/slam.e.json", 3, "03"}}};
  snapshot.scans = {scan};
  snapshot.registry = {{"rows", "block", "key", {"registry/rows/d.h5", 2, "02"}}};
  return snapshot;
}

TEST(SnapshotJson, EverythingComesBackAndTextIsStable) {
  const Snapshot snapshot = sample_snapshot();
  const std::string text = to_json(snapshot).dump();
  const auto back = snapshot_from_json(nlohmann::ordered_json::parse(text), "x");
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(to_json(*back).dump(), text);
  EXPECT_EQ(back->scans[0].start_time_s, 1549843200.123456);
  EXPECT_EQ(back->scans[0].name, "véraison");
  EXPECT_EQ(back->scans[0].tiles[0].index, (TileIndex{-3, 7}));
  EXPECT_EQ(back->scans[0].tiles[0].more_files.size(), 1U);
  EXPECT_EQ(back->scans[0].tiles[0].bounds.max(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(back->scans[0].attachments.at(0).name, "slam.json");
  EXPECT_EQ(back->scans[0].attachments[0].file.size, 3U);
  EXPECT_EQ(back->registry[0].file.path, "registry/rows/d.h5");
  EXPECT_NE(back->find_scan("2019-02-11_veraison"), nullptr);
  EXPECT_EQ(back->find_scan("2019-02-11"), nullptr);
}

TEST(SnapshotJson, TheBeamComesBackWithAndWithoutItsShareOrIsAbsent) {
  for (const std::optional<LidarBeam>& beam :
       {std::optional<LidarBeam>(), std::optional(LidarBeam{0.0136, 0.0119, std::nullopt}),
        std::optional(LidarBeam{0.011, 0.0021, 0.3, 0.15}),
        std::optional(LidarBeam{0.011, 0.0021, {}, {}, ReturnMode::strongest})}) {
    Snapshot snapshot = sample_snapshot();
    snapshot.scans[0].beam = beam;
    const auto json = to_json(snapshot);
    EXPECT_EQ(json["scans"][0].contains("beam"), beam.has_value());
    const auto back = snapshot_from_json(json, "x");
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(back->scans[0].beam, beam);
  }
}

TEST(SnapshotJson, AnEchoThatNoLidarReportsIsRefused) {
  Snapshot snapshot = sample_snapshot();
  snapshot.scans[0].beam = LidarBeam{0.011, 0.0021, {}, {}, ReturnMode::last};
  auto json = to_json(snapshot);
  json["scans"][0]["beam"]["returns"] = "loudest";
  const auto back = snapshot_from_json(json, "x");
  ASSERT_FALSE(back);
  EXPECT_NE(back.error().line().find("'loudest' is no echo"), std::string::npos) << back.error().line();
}

TEST(SnapshotJson, AScanFromBeforeFilesWereKeptHasNone) {
  auto json = to_json(sample_snapshot());
  json["scans"][0].erase("attachments");
  const auto back = snapshot_from_json(json, "x");
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_TRUE(back->scans[0].attachments.empty());
}

TEST(SnapshotJson, WhetherAScanIsDormantIsKeptWhereItWasSaidAndAbsentWhereNot) {
  Snapshot snapshot = sample_snapshot();
  EXPECT_EQ(to_json(snapshot).dump().find("dormant"), std::string::npos) << "as older versions wrote it";
  EXPECT_EQ(snapshot_from_json(to_json(snapshot), "x")->scans[0].dormant, std::nullopt);
  for (const bool dormant : {false, true}) {
    snapshot.scans[0].dormant = dormant;
    EXPECT_EQ(snapshot_from_json(to_json(snapshot), "x")->scans[0].dormant, dormant);
  }
  auto json = to_json(snapshot);
  json["scans"][0]["dormant"] = "perhaps";
  EXPECT_EQ(snapshot_from_json(json, "x").error().code, ErrorCode::damaged);
}

TEST(SnapshotJson, ASnapshotOfANewerFormatAsksForANewerProgram) {
  auto json = to_json(sample_snapshot());
  json["version"] = 2;
  const auto back = snapshot_from_json(json, "x");
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, ErrorCode::bad_input);
  EXPECT_NE(back.error().line().find("newer rayfield"), std::string::npos) << back.error().line();
}

// Whatever they are converted to is undefined in C++ (found by fuzzing).
TEST(SnapshotJson, NumbersThatDoNotFitAreRefused) {
  const auto code_with = [](const auto& set) {
    auto json = to_json(sample_snapshot());
    set(json["scans"][0]);
    const auto back = snapshot_from_json(json, "x");
    return back ? ErrorCode::internal : back.error().code;
  };
  for (const nlohmann::ordered_json& number : {nlohmann::ordered_json(6e92), nlohmann::ordered_json(-1),
                                               nlohmann::ordered_json(1.5), nlohmann::ordered_json("3")}) {
    EXPECT_EQ(code_with([&](auto& scan) { scan["rays"] = number; }), ErrorCode::damaged) << number;
    EXPECT_EQ(code_with([&](auto& scan) { scan["tiles"][0]["files"][0]["size"] = number; }), ErrorCode::damaged)
        << number;
  }
  EXPECT_EQ(code_with([](auto& scan) { scan["tiles"][0]["tile"][0] = 3000000000; }), ErrorCode::damaged);
  EXPECT_EQ(code_with([](auto& scan) { scan["tiles"][0]["tile"][0] = -3000000000; }), ErrorCode::damaged);
}

TEST(SnapshotJson, PathsThatLeadOutOfTheStoreAreRefused) {
  for (const char* path : {"/etc/passwd", "../other/tile.h5", "scans/../../x", "scans/2019-02-11/rays/a.h5/", ""}) {
    Snapshot snapshot = sample_snapshot();
    snapshot.scans[0].tiles[0].file.path = path;
    Snapshot attached = sample_snapshot();
    attached.scans[0].attachments[0].file.path = path;
    EXPECT_FALSE(snapshot_from_json(to_json(attached), "x")) << path;
    const auto back = snapshot_from_json(to_json(snapshot), "x");
    ASSERT_FALSE(back) << path;
    EXPECT_EQ(back.error().code, ErrorCode::damaged);
  }
}

TEST(SnapshotJson, LostSnapshotsComeBackAndAreAbsentWhereThereAreNone) {
  Snapshot snapshot = sample_snapshot();
  EXPECT_FALSE(to_json(snapshot).contains("lost")) << "as older versions wrote it";
  snapshot.lost = {{2, 2}, {4, 6}};
  EXPECT_EQ(snapshot_from_json(to_json(snapshot), "x")->lost, snapshot.lost);
}

// Ids and names become folders: a sealed snapshot of a stranger may hold anything.
TEST(SnapshotJson, NamesThatAreNoNamesAndScansThatStandThereTwiceAreRefused) {
  const auto refused = [](const Snapshot& snapshot) {
    const auto back = snapshot_from_json(to_json(snapshot), "x");
    return !back && back.error().code == ErrorCode::damaged;
  };
  ASSERT_FALSE(refused(sample_snapshot()));
  for (const char* id : {"..", "", "2019-02-11/x", "2018-01-01", "2019-02-11_\n", "x"}) {
    Snapshot snapshot = sample_snapshot();
    snapshot.scans[0].scan_id = id;
    EXPECT_TRUE(refused(snapshot)) << id;
  }
  Snapshot twice = sample_snapshot();
  twice.scans.push_back(twice.scans[0]);
  EXPECT_TRUE(refused(twice));
  Snapshot kind = sample_snapshot();
  kind.scans[0].derived[0].kind = "..";
  EXPECT_TRUE(refused(kind));
  Snapshot name = sample_snapshot();
  name.registry[0].name = "a/b";
  EXPECT_TRUE(refused(name));
  Snapshot attachment = sample_snapshot();
  attachment.scans[0].attachments[0].name = "../slam.json";
  EXPECT_TRUE(refused(attachment));
}

TEST(SnapshotJson, AnyMissingKeyIsDamageNotACrash) {
  const auto whole = to_json(sample_snapshot());
  for (const auto& [key, value] : whole.items()) {
    auto json = whole;
    json.erase(key);
    const auto back = snapshot_from_json(json, "x");
    ASSERT_FALSE(back) << key;
    EXPECT_EQ(back.error().code, ErrorCode::damaged) << key;
  }
}

}  // namespace
}  // namespace rayfield::tile::testing
