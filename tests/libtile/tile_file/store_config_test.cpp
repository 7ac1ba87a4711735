#include "rayfield/tile/store_config.h"

#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

TEST(StoreConfig, SettingsThatMakeNoSenseAreRefused) {
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

}  // namespace
}  // namespace rayfield::tile::testing
