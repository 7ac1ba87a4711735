#include "rayfield/tile/array_reader.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <numeric>
#include <vector>

#include "rayfield/core/sha256.h"
#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

class StoredArrays : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(add(store_, simulated_drive(1000)));
    auto writer = store_.write_derived();
    ASSERT_TRUE(writer) << writer.error().line();
    values_.resize(300001);
    std::iota(values_.begin(), values_.end(), 0.5F);
    ArraySet arrays;
    arrays.kind = "raster", arrays.attributes = R"({"name":"a"})";
    arrays.columns["values"] = values_;
    arrays.columns["rows"] = std::vector<std::int32_t>{4, 5};
    auto entry = writer->put({"2019-02-11", "raster", "a", sha256_hex("1")}, arrays);
    ASSERT_TRUE(entry) << entry.error().line();
    entry_ = *entry;
  }
  ScratchFolder folder_;
  Store store_ = make_store(folder_.path() / "block");
  std::vector<float> values_;
  DerivedEntry entry_;
};

TEST_F(StoredArrays, GiveAnyPartOfAColumnInAnyOrder) {
  const auto reader = store_.open_derived(entry_);
  ASSERT_TRUE(reader) << reader.error().line();
  EXPECT_EQ(reader->header().kind, "raster");
  EXPECT_EQ(reader->header().attributes, R"({"name":"a"})");
  EXPECT_EQ(reader->count("values"), values_.size());
  for (const auto& [first, size] : {std::pair<std::size_t, std::size_t>{131000, 200},  // over a chunk's end
                                    {0, 300001},
                                    {300000, 1},
                                    {5, 0},
                                    {262143, 2}}) {
    std::vector<float> part(size);
    ASSERT_TRUE(reader->read("values", first, part)) << first;
    for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(part[i], values_[first + i]) << first << " + " << i;
  }
}

TEST_F(StoredArrays, GiveTheOtherColumnsWithoutALargeOne) {
  const auto arrays = store_.open_derived(entry_)->read_without({"values"});
  ASSERT_TRUE(arrays) << arrays.error().line();
  EXPECT_EQ(arrays->columns.size(), 1U);
  EXPECT_EQ(*arrays->column<std::int32_t>("rows")->begin(), 4);
}

TEST_F(StoredArrays, RefuseWhatIsNotThere) {
  const auto reader = store_.open_derived(entry_);
  std::vector<float> two(2);
  EXPECT_EQ(reader->read("values", 300000, two).error().code, ErrorCode::damaged);
  EXPECT_EQ(reader->read("rows", 0, two).error().code, ErrorCode::damaged) << "of another type";
  EXPECT_EQ(reader->count("none").error().code, ErrorCode::damaged);
}

TEST_F(StoredArrays, ThatAreDamagedOrMissingAreRefusedBeforeAnythingIsReadOfThem) {
  const std::filesystem::path path = store_.folder() / entry_.file.path;
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  std::filesystem::resize_file(path, entry_.file.size - 1);
  EXPECT_EQ(store_.open_derived(entry_).error().code, ErrorCode::damaged);
  std::filesystem::remove(path);
  EXPECT_EQ(store_.open_derived(entry_).error().code, ErrorCode::damaged);
}

}  // namespace
}  // namespace rayfield::tile::testing
