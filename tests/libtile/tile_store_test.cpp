#include <gmock/gmock.h>

#include "libtile/files/sealed_json.h"
#include "libtile/store/snapshot_json.h"
#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::HasSubstr;

TEST(Store, ANewStoreIsEmptyAndOpensAgain) {
  ScratchFolder folder;
  const fs::path path = folder.path() / "deep" / "Block A";
  const Store store = make_store(path);
  EXPECT_EQ(store.block_name(), "Block A");
  EXPECT_EQ(store.latest()->number, 0U);
  EXPECT_TRUE(store.history()->empty());
  const auto again = Store::open(path);
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(again->config().crs, "EPSG:7854");
  EXPECT_EQ(again->config().tile_size_m, 25.0);
  EXPECT_EQ(again->config().tile_margin_m, 0.25);
  EXPECT_TRUE(damage_of(*again).empty());
}

TEST(Store, CreatingTheSameStoreAgainChangesNothing) {
  ScratchFolder folder;
  make_store(folder.path() / "block");
  const auto before = contents(folder.path());
  EXPECT_TRUE(Store::create(folder.path() / "block", test_config()));
  EXPECT_EQ(contents(folder.path()), before);
}

TEST(Store, AStoreWithOtherSettingsIsNotOverwritten) {
  ScratchFolder folder;
  make_store(folder.path() / "block");
  StoreConfig other = test_config();
  other.tile_size_m = 50;
  const auto store = Store::create(folder.path() / "block", other);
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::usage);
}

TEST(Store, AFolderWithOtherThingsInItIsLeftAlone) {
  ScratchFolder folder;
  write_text(folder.path() / "holiday.jpg", "x");
  const auto store = Store::create(folder.path(), test_config());
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::usage);
  EXPECT_THAT(store.error().line(), HasSubstr("holiday.jpg"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1) << "nothing was put beside it";
}

TEST(Store, AFileCannotBecomeAStore) {
  ScratchFolder folder;
  write_text(folder.path() / "cloud.ply", "ply");
  const auto store = Store::create(folder.path() / "cloud.ply", test_config());
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::usage);
}

TEST(Store, SettingsThatMakeNoSenseAreRefused) {
  const auto code = [](const auto& change) {
    StoreConfig config = test_config();
    change(config);
    const auto valid = config.validate();
    return valid ? std::optional<ErrorCode>() : valid.error().code;
  };
  EXPECT_FALSE(code([](StoreConfig&) {}));
  EXPECT_EQ(code([](StoreConfig& c) { c.crs = "EPSG:4326"; }), ErrorCode::usage);
  EXPECT_EQ(code([](StoreConfig& c) { c.crs = "EPSG:999999"; }), ErrorCode::usage);
  EXPECT_EQ(code([](StoreConfig& c) { c.tile_size_m = 1; }), ErrorCode::usage);
  EXPECT_EQ(code([](StoreConfig& c) { c.tile_size_m = std::nan(""); }), ErrorCode::usage);
  EXPECT_EQ(code([](StoreConfig& c) { c.tile_size_m = 25.00005; }), ErrorCode::usage);
  EXPECT_EQ(code([](StoreConfig& c) { c.tile_margin_m = -1; }), ErrorCode::usage);
  EXPECT_EQ(code([](StoreConfig& c) { c.tile_margin_m = 7; }), ErrorCode::usage);
}

TEST(Store, AFolderThatIsNoStoreIsNamed) {
  ScratchFolder folder;
  for (const fs::path& path : {folder.path(), folder.path() / "absent"}) {
    const auto store = Store::open(path);
    ASSERT_FALSE(store);
    EXPECT_EQ(store.error().code, ErrorCode::bad_input);
    EXPECT_THAT(store.error().line(), HasSubstr(path.string()));
  }
}

TEST(Store, AStoreOfANewerFormatAsksForANewerProgram) {
  ScratchFolder folder;
  make_store(folder.path() / "block");
  auto json = to_json(test_config());
  json["version"] = 2;
  write_text(folder.path() / "block" / "store.json", seal_json("store", json));
  const auto store = Store::open(folder.path() / "block");
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::bad_input);
  EXPECT_THAT(store.error().line(), HasSubstr("newer"));
}

TEST(Store, AnyChangedByteOfTheStoreFileIsDamage) {
  ScratchFolder folder;
  make_store(folder.path() / "block");
  const fs::path file = folder.path() / "block" / "store.json";
  const std::string good = file_text(file);
  for (std::size_t i = 0; i < good.size(); ++i) {
    flip_bit(file, i, 1);
    const auto store = Store::open(folder.path() / "block");
    ASSERT_FALSE(store) << i;
    EXPECT_EQ(store.error().code, ErrorCode::damaged) << i;
    write_text(file, good);
  }
}

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
  EXPECT_EQ(back->registry[0].file.path, "registry/rows/d.h5");
  EXPECT_NE(back->find_scan("2019-02-11_veraison"), nullptr);
  EXPECT_EQ(back->find_scan("2019-02-11"), nullptr);
}

TEST(SnapshotJson, PathsThatLeadOutOfTheStoreAreRefused) {
  for (const char* path : {"/etc/passwd", "../other/tile.h5", "scans/../../x", ""}) {
    Snapshot snapshot = sample_snapshot();
    snapshot.scans[0].tiles[0].file.path = path;
    const auto back = snapshot_from_json(to_json(snapshot), "x");
    ASSERT_FALSE(back) << path;
    EXPECT_EQ(back.error().code, ErrorCode::damaged);
  }
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

TEST(SnapshotJson, ContentOfATileDependsOnAllItsFiles) {
  TileEntry tile = sample_snapshot().scans[0].tiles[0];
  const std::string both = tile.content_sha256();
  tile.more_files[0].sha256 = "00";
  EXPECT_NE(tile.content_sha256(), both);
  tile.more_files.clear();
  EXPECT_EQ(tile.content_sha256(), tile.file.sha256);
}

}  // namespace
}  // namespace rayfield::tile::testing
