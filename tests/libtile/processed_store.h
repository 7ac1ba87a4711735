#pragma once

#include <gtest/gtest.h>

#include "rayfield/core/sha256.h"
#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {

/// A store with one scan and one derived file.
class ProcessedStore : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(add(store_, simulated_drive(20000)));
    auto writer = store_.write_derived();
    ArraySet arrays;
    arrays.kind = "ground";
    arrays.columns["z"] = std::vector<float>(1000, 1.5F);
    const auto entry = writer->put({"2019-02-11", "ground", "block", sha256_hex("k")}, arrays);
    ASSERT_TRUE(writer->set("2019-02-11", {*entry}));
    ASSERT_TRUE(writer->commit("process"));
    ASSERT_TRUE(damage_of(store_).empty());
  }
  ScratchFolder folder_;
  Store store_ = make_store(folder_.path() / "block");
};

}  // namespace rayfield::tile::testing
