#include "tests/libtile/processed_store.h"

namespace rayfield::tile::testing {
namespace {

class Garbage : public ProcessedStore {};

TEST_F(Garbage, GcRemovesWhatNoSnapshotNamesAndNothingElse) {
  const auto before = contents(store_.folder());
  fs::create_directories(store_.folder() / "scans" / "2018-01-01" / "rays");
  write_text(store_.folder() / "scans" / "2018-01-01" / "rays" / "0_0.h5", std::string(1000, 'x'));
  write_text(store_.folder() / "registry" / "stray", std::string(10, 'x'));
  write_text(store_.folder() / "tmp" / "0123.tmp", std::string(100, 'x'));
  EXPECT_EQ(store_.gc(true).value(), 1110U);
  EXPECT_TRUE(fs::exists(store_.folder() / "tmp" / "0123.tmp"));
  EXPECT_EQ(store_.gc(false).value(), 1110U);
  EXPECT_EQ(contents(store_.folder()), before);
  EXPECT_FALSE(fs::exists(store_.folder() / "scans" / "2018-01-01"));
  EXPECT_EQ(store_.gc(false).value(), 0U);
  EXPECT_TRUE(damage_of(store_).empty());
}

}  // namespace
}  // namespace rayfield::tile::testing
