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

TEST(Store, AFolderThatIsNoStoreIsNamed) {
  ScratchFolder folder;
  for (const fs::path& path : {folder.path(), folder.path() / "absent"}) {
    const auto store = Store::open(path);
    ASSERT_FALSE(store);
    EXPECT_EQ(store.error().code, ErrorCode::bad_input);
    EXPECT_THAT(store.error().line(), HasSubstr(path.string()));
  }
}

TEST(Store, WhetherAScanIsDormantIsChangedWithoutTouchingIt) {
  const ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  ASSERT_TRUE(add(store, simulated_drive(2000)));
  const Snapshot before = *store.latest();
  EXPECT_EQ(before.scans[0].dormant, std::nullopt);
  ASSERT_TRUE(store.set_dormant("2019-02-11", true, "test"));
  const Snapshot after = *store.latest();
  EXPECT_EQ(after.scans[0].dormant, true);
  EXPECT_EQ(after.number, before.number + 1);
  EXPECT_EQ(after.scans[0].tiles[0].content_sha256(), before.scans[0].tiles[0].content_sha256());
  ASSERT_TRUE(store.set_dormant("2019-02-11", true, "test"));
  EXPECT_EQ(store.latest()->number, after.number) << "nothing new, no snapshot";
  EXPECT_EQ(store.set_dormant("2020-01-01", true, "test").error().code, ErrorCode::usage);
}

TEST(Store, AScanIsAddedAsDormant) {
  const ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  AddOptions options = add_options();
  options.dormant = true;
  ASSERT_TRUE(add(store, simulated_drive(2000), options));
  EXPECT_EQ(store.latest()->scans[0].dormant, true);
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

}  // namespace
}  // namespace rayfield::tile::testing
