#include <gmock/gmock.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "rayfield/core/sha256.h"
#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

ArraySet ground(float height) {
  ArraySet arrays;
  arrays.kind = "ground";
  arrays.attributes = R"({"cell_m": 0.5})";
  arrays.columns["z"] = std::vector<float>(100, height);
  return arrays;
}

NewDerived named(const std::string& name, const std::string& inputs, const std::string& scan = "2019-02-11") {
  return {scan, "ground", name, sha256_hex(inputs)};
}

class Derived : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(add(store_, simulated_drive(1000))); }
  ScratchFolder folder_;
  Store store_ = make_store(folder_.path() / "block");
};

TEST_F(Derived, WhatIsPutAndCommittedIsReadBack) {
  {
    auto writer = store_.write_derived();
    ASSERT_TRUE(writer) << writer.error().line();
    auto b = writer->put(named("b", "1"), ground(2));
    auto a = writer->put(named("a", "1"), ground(1));
    ASSERT_TRUE(a && b);
    auto rows = ground(3);
    rows.kind = "rows";
    auto r = writer->put({"", "rows", "block", sha256_hex("r")}, rows);
    ASSERT_TRUE(r) << r.error().line();
    ASSERT_TRUE(writer->set("2019-02-11", {*b, *a}));
    ASSERT_TRUE(writer->set("", {*r}));
    const auto snapshot = writer->commit("rayfield process");
    ASSERT_TRUE(snapshot) << snapshot.error().line();
    EXPECT_EQ(snapshot->number, 2U);
  }
  const Snapshot snapshot = *store_.latest();
  const auto& derived = snapshot.scans.at(0).derived;
  ASSERT_EQ(derived.size(), 2U);
  EXPECT_EQ(derived[0].name, "a");
  EXPECT_EQ(derived[1].name, "b");
  EXPECT_EQ(store_.read_derived(derived[1])->columns, ground(2).columns);
  EXPECT_EQ(snapshot.registry.at(0).kind, "rows");
  EXPECT_TRUE(store_.read_derived(snapshot.registry[0]));
  EXPECT_TRUE(damage_of(store_).empty());
}

// It is not the disk, nor an input, that keeps the file from being written anew.
TEST_F(Derived, AFolderInPlaceOfAFileIsDamageForWhoeverWritesItAnew) {
  auto writer = store_.write_derived();
  const auto entry = writer->put(named("a", "1"), ground(1));
  ASSERT_TRUE(entry);
  fs::remove(store_.folder() / entry->file.path);
  fs::create_directory(store_.folder() / entry->file.path);
  const auto again = writer->put(named("a", "1"), ground(1));
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::damaged) << again.error().line();
  EXPECT_THAT(again.error().line(), ::testing::HasSubstr(entry->file.path + ": a folder stands in place"));
  EXPECT_EQ(std::distance(fs::directory_iterator(store_.folder() / "tmp"), fs::directory_iterator()), 0);
}

// More than one chunk, and the last one not full.
std::vector<float> many_values() {
  std::vector<float> values(300001);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i % 1013) / 7;
  return values;
}

TEST_F(Derived, AColumnThatComesPartByPartMakesTheSameFile) {
  auto writer = store_.write_derived();
  ASSERT_TRUE(writer) << writer.error().line();
  const std::vector<float> values = many_values();
  ArraySet whole = ground(1);
  whole.columns["a"] = std::vector<std::int32_t>{1, 2, 3};
  StreamedArrays parts{whole, {}};
  whole.columns["values"] = values;
  std::uint64_t next = 0;
  parts.streamed["values"] = {values.size(), [&](std::uint64_t first, std::span<float> part) -> Result<void> {
                                EXPECT_EQ(std::exchange(next, first + part.size()), first);
                                std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(first), part.size(),
                                            part.begin());
                                return {};
                              }};
  const auto at_once = writer->put(named("whole", "1"), whole), in_parts = writer->put(named("parts", "1"), parts);
  ASSERT_TRUE(at_once && in_parts);
  EXPECT_EQ(next, values.size());
  EXPECT_EQ(at_once->file.sha256, in_parts->file.sha256);
}

TEST_F(Derived, WhatTheSourceOfAColumnFailsWithIsReturnedAndNoFileStays) {
  auto writer = store_.write_derived();
  ASSERT_TRUE(writer) << writer.error().line();
  StreamedArrays parts{ground(1), {}};
  parts.streamed["values"] = {200000, [](std::uint64_t first, std::span<float>) -> Result<void> {
                                if (first == 0) return {};
                                return fail(ErrorCode::resources, "cannot read", "there", "gone");
                              }};
  const auto put = writer->put(named("parts", "1"), parts);
  ASSERT_FALSE(put.has_value());
  EXPECT_EQ(put.error().code, ErrorCode::resources);
  EXPECT_FALSE(writer->find(named("parts", "1")).has_value());
}

TEST_F(Derived, WithoutCommitNothingChangesButTheWorkIsFoundAgain) {
  {
    auto writer = store_.write_derived();
    ASSERT_TRUE(writer->put(named("a", "1"), ground(1)));
  }
  EXPECT_EQ(store_.latest()->number, 1U);
  auto writer = store_.write_derived();
  EXPECT_FALSE(writer->find(named("a", "2"))) << "another key";
  EXPECT_FALSE(writer->find(named("b", "1"))) << "another name";
  const auto found = writer->find(named("a", "1"));
  ASSERT_TRUE(found);
  ASSERT_TRUE(writer->set("2019-02-11", {*found}));
  ASSERT_TRUE(writer->commit("rayfield process"));
  EXPECT_EQ(store_.read_derived(store_.latest()->scans.at(0).derived.at(0))->columns, ground(1).columns);
}

TEST_F(Derived, AnUnpublishedFileThatIsDamagedIsNotFoundAndIsWrittenAnew) {
  DerivedEntry entry;
  {
    auto writer = store_.write_derived();
    entry = *writer->put(named("a", "1"), ground(1));
  }
  flip_bit(store_.folder() / entry.file.path, 700);
  auto writer = store_.write_derived();
  EXPECT_FALSE(writer->find(named("a", "1")));
  const auto again = writer->put(named("a", "1"), ground(1));
  ASSERT_TRUE(again);
  EXPECT_EQ(again->file.sha256, entry.file.sha256);
  EXPECT_TRUE(store_.read_derived(*again));
}

TEST_F(Derived, APublishedFileThatIsDamagedIsNotTakenForGood) {
  DerivedEntry entry;
  {
    auto writer = store_.write_derived();
    entry = *writer->put(named("a", "1"), ground(1));
    ASSERT_TRUE(writer->set("2019-02-11", {entry}));
    ASSERT_TRUE(writer->commit("x"));
  }
  flip_bit(store_.folder() / entry.file.path, 700);
  auto writer = store_.write_derived();
  EXPECT_FALSE(writer->find(named("a", "1")));
  ASSERT_TRUE(writer->put(named("a", "1"), ground(1)));
  EXPECT_TRUE(damage_of(store_).empty()) << "writing it again has repaired the store";
}

TEST_F(Derived, AKeyThatIsPublishedIsKept) {
  auto writer = store_.write_derived();
  const auto first = writer->put(named("a", "1"), ground(1));
  ASSERT_TRUE(writer->set("2019-02-11", {*first}));
  ASSERT_TRUE(writer->commit("x"));
  const auto second = writer->put(named("a", "1"), ground(9));
  ASSERT_TRUE(second);
  EXPECT_EQ(second->file.sha256, first->file.sha256);
}

TEST_F(Derived, CommittingTheSameAgainMakesNoNewSnapshot) {
  auto writer = store_.write_derived();
  const auto entry = writer->put(named("a", "1"), ground(1));
  ASSERT_TRUE(writer->set("2019-02-11", {*entry}));
  EXPECT_EQ(writer->commit("x")->number, 2U);
  ASSERT_TRUE(writer->set("2019-02-11", {*entry}));
  EXPECT_EQ(writer->commit("x")->number, 2U);
  ASSERT_TRUE(writer->set("2019-02-11", {}));
  EXPECT_EQ(writer->commit("x")->number, 3U);
}

TEST_F(Derived, OnlyWrittenFilesOfKnownScansCanBeSet) {
  auto writer = store_.write_derived();
  EXPECT_EQ(writer->set("2020-01-01", {}).error().code, ErrorCode::usage);
  DerivedEntry invented{"ground", "a", sha256_hex("1"), {"scans/2019-02-11/ground/none.h5", 5, sha256_hex("2")}};
  EXPECT_FALSE(writer->set("2019-02-11", {invented}));
  const auto entry = writer->put(named("a", "1"), ground(1));
  EXPECT_FALSE(writer->set("2019-02-11", {*entry, *entry}));
}

TEST_F(Derived, NamesThatWouldLeaveTheFolderAreRefused) {
  auto writer = store_.write_derived();
  for (const char* name : {"../a", "a/b", "", ".a"}) EXPECT_FALSE(writer->put(named(name, "1"), ground(1))) << name;
  NewDerived rays = named("a", "1");
  rays.kind = "rays";
  EXPECT_FALSE(writer->put(rays, ground(1)));
}

TEST_F(Derived, ManyThreadsMayPutAtOnce) {
  auto writer = store_.write_derived();
  std::vector<DerivedEntry> entries(24);
  std::vector<std::jthread> threads;
  for (std::size_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (std::size_t i = t; i < entries.size(); i += 4)
        entries[i] = writer->put(named(std::to_string(i), "k"), ground(static_cast<float>(i))).value();
    });
  }
  threads.clear();
  ASSERT_TRUE(writer->set("2019-02-11", entries));
  ASSERT_TRUE(writer->commit("x"));
  EXPECT_TRUE(damage_of(store_).empty());
  EXPECT_EQ(store_.latest()->scans.at(0).derived.size(), 24U);
}

TEST_F(Derived, OverwritingAScanDropsWhatWasDerivedFromIt) {
  {
    auto writer = store_.write_derived();
    const auto entry = writer->put(named("a", "1"), ground(1));
    ASSERT_TRUE(writer->set("2019-02-11", {*entry}));
    ASSERT_TRUE(writer->commit("x"));
  }
  AddOptions options = add_options();
  options.overwrite = true;
  ASSERT_TRUE(add(store_, simulated_drive(500), options));
  EXPECT_TRUE(store_.latest()->scans.at(0).derived.empty());
}

}  // namespace
}  // namespace rayfield::tile::testing
