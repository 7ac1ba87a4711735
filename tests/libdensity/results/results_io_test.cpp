#include "libdensity/results/results_io.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "libdensity/results/leaf_values.h"

namespace rayfield::density {
namespace {

constexpr double kNaN = CanopyDescriptors::kUndefined;

/// A row of two panels, the second not scanned.
RowLayout two_panels() {
  RowLayout layout;
  layout.panels = {{1, 1, 0, 5}, {1, 2, 5, 10}};
  layout.panels[0].identity.uid = "first", layout.panels[1].identity.uid = "second";
  return layout;
}

ScanProduct scan() {
  ScanProduct scan;
  scan.scan_id = "id", scan.scan_date = "2019-02-11";
  return scan;
}

ScanResults stored_results() {
  ScanResults results;
  results.scan.fruit_zone_low_m = 0.7, results.scan.fruit_zone_high_m = 1.1;
  results.panel_values.resize(2);
  results.panel_values[0].panel_uid = "first", results.panel_values[1].panel_uid = "second";
  results.panel_values[0].descriptors = {0.9, 0.1, 0.2, 2.5, 0.6, 0.4, 2.0};
  RowMetreProduct metre;
  metre.row_number = 1, metre.canopy_height_m = 1.9, metre.canopy_width_m = 0.6;
  metre.descriptors = {0.8, 0, 0.3, 2.25, 0.7, 0.5, 1.5};
  results.row_metres = {metre, RowMetreProduct{}};
  results.profile = {{"first", {}, {}, 0.75, 1, 3, 2}, {"second", {}, {}, 0.75, 1, kNaN, kNaN}};
  return results;
}

void expect_equal(const CanopyDescriptors& a, const CanopyDescriptors& b) {
  for (const auto member :
       {&CanopyDescriptors::canopy_base_m, &CanopyDescriptors::row_gap_share, &CanopyDescriptors::porosity,
        &CanopyDescriptors::leaf_layer_number, &CanopyDescriptors::exposed_leaf_share,
        &CanopyDescriptors::fruit_zone_area_per_m, &CanopyDescriptors::fruit_zone_density}) {
    if (std::isnan(b.*member)) {
      EXPECT_TRUE(std::isnan(a.*member));
    } else {
      EXPECT_EQ(a.*member, b.*member);
    }
  }
}

tile::ArraySet arrays_of(const ScanResults& results) { return results_to_arrays(results, two_panels(), {}).arrays; }

TEST(StoredResults, GiveBackCanopyDescriptorsAndProfiles) {
  const ScanResults results = stored_results();
  const auto read = results_from_arrays(arrays_of(results), two_panels(), scan());
  ASSERT_TRUE(read) << read.error().line();
  for (std::size_t i = 0; i < 2; ++i) {
    expect_equal(read->panel_values[i].descriptors, results.panel_values[i].descriptors);
    expect_equal(read->row_metres[i].descriptors, results.row_metres[i].descriptors);
  }
  EXPECT_EQ(read->row_metres[0].canopy_height_m, 1.9);
  EXPECT_EQ(read->row_metres[0].canopy_width_m, 0.6);
  EXPECT_TRUE(std::isnan(read->row_metres[1].canopy_height_m));
  EXPECT_EQ(read->scan.fruit_zone_low_m, 0.7);
  EXPECT_EQ(read->scan.fruit_zone_high_m, 1.1);
  ASSERT_EQ(read->profile.size(), 2U);
  EXPECT_EQ(read->profile[0].panel_uid, "first");
  EXPECT_EQ(read->profile[0].scan_id, "id");
  EXPECT_EQ(read->profile[0].plant_area_m2, 3);
  EXPECT_EQ(read->profile[0].leaf_area_m2, 2);
  EXPECT_TRUE(std::isnan(read->profile[1].leaf_area_m2));
}

TEST(StoredResults, OfEarlierVersionsHaveNoDescriptors) {
  tile::ArraySet arrays = arrays_of(stored_results());
  std::erase_if(arrays.columns, [](const auto& column) {
    const std::string& name = column.first;
    for (const char* part :
         {"canopy_base", "gap_share", "porosity", "layer", "exposed", "fruit", "metre_canopy", "profile"})
      if (name.find(part) != std::string::npos) return true;
    return false;
  });
  arrays.attributes = R"({"sections": [], "element_area_m2": 0.007})";
  const auto read = results_from_arrays(arrays, two_panels(), scan());
  ASSERT_TRUE(read) << read.error().line();
  expect_equal(read->panel_values[0].descriptors, {});
  expect_equal(read->row_metres[0].descriptors, {});
  EXPECT_TRUE(std::isnan(read->row_metres[0].canopy_height_m));
  EXPECT_TRUE(std::isnan(read->scan.fruit_zone_low_m));
  EXPECT_TRUE(read->profile.empty());
}

TEST(StoredResults, WithAColumnCutShortAreDamaged) {
  for (const char* name : {"panel_porosity", "metre_porosity", "metre_canopy_width_m", "profile_height_low_m"}) {
    tile::ArraySet arrays = arrays_of(stored_results());
    arrays.columns[name] = std::vector<double>{1};
    const auto read = results_from_arrays(arrays, two_panels(), scan());
    ASSERT_FALSE(read) << name;
    EXPECT_EQ(read.error().code, ErrorCode::damaged);
  }
}

TEST(StoredLeaves, TakeThePlaceOfWhatIsOfLeavesAndLeaveWhatIsOfPlants) {
  ScanResults results = *results_from_arrays(arrays_of(stored_results()), two_panels(), scan());
  LeafValues leaf{"winter", "content", results.panel_values, results.row_metres, {1.5, kNaN}};
  leaf.panels[0].descriptors = {kNaN, 1, 0.9, 2, 0.5, 0.3, 1.75};
  leaf.metres[0].descriptors = {kNaN, 1, 0.9, 1.5, 0.8, 0.25, 1.25};
  leaf.metres[0].leaf_area_per_m = 4;
  ASSERT_TRUE(put_leaf_values(leaf_to_arrays(leaf, two_panels()), two_panels(), results));
  expect_equal(results.panel_values[0].descriptors, {0.9, 0.1, 0.2, 2, 0.5, 0.3, 1.75});
  expect_equal(results.row_metres[0].descriptors, {0.8, 0, 0.3, 1.5, 0.8, 0.25, 1.25});
  EXPECT_EQ(results.row_metres[0].leaf_area_per_m, 4);
  EXPECT_EQ(results.profile[0].leaf_area_m2, 1.5);
  EXPECT_EQ(results.profile[0].plant_area_m2, 3);
  EXPECT_EQ(results.scan.wood_scan_id, "winter");
}

// Somebody who sealed a file anew may have put anything there.
TEST(StoredRasters, WithoutAPlaceOrWithInfiniteValuesAreDamaged) {
  const auto raster_with = [](double east, double cell_m) {
    const RasterProduct raster{"ground", "m", "height", Grid2<float>({east, 0}, cell_m, 2, 2)};
    return raster_of(raster_to_arrays(raster, {}).arrays, 4);
  };
  EXPECT_TRUE(raster_with(3, 0.5));
  for (const auto& raster : {raster_with(3, 0), raster_with(3, -1), raster_with(kNaN, 0.5)}) {
    ASSERT_FALSE(raster);
    EXPECT_EQ(raster.error().code, ErrorCode::damaged);
  }
  const float infinite = std::numeric_limits<float>::infinity(), undefined = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(check_map_values(std::vector{0.0F, undefined}, "ground"));
  const auto values = check_map_values(std::vector{0.0F, -infinite}, "ground");
  ASSERT_FALSE(values);
  EXPECT_EQ(values.error().code, ErrorCode::damaged);
}

// Conversions of the JSON library leave undefined what becomes of numbers that do not fit (found by fuzz_derived).
TEST(StoredRasters, WithASizeThatIsNoWholeNumberAreDamaged) {
  const RasterProduct raster{"ground", "m", "height", Grid2<float>({3, 0}, 0.5, 2, 2)};
  for (const char* size : {"31e99", "-31e99", "2.5", "4294967298", "\"2\""}) {
    tile::ArraySet arrays = raster_to_arrays(raster, {}).arrays;
    const std::size_t at = arrays.attributes.find("\"nx\":2");
    ASSERT_NE(at, std::string::npos) << arrays.attributes;
    arrays.attributes.replace(at, 6, std::string("\"nx\":") + size);
    const auto read = raster_of(arrays, 4);
    ASSERT_FALSE(read) << size;
    EXPECT_EQ(read.error().code, ErrorCode::damaged);
    EXPECT_NE(read.error().why.find("no whole number"), std::string::npos) << read.error().why;
  }
}

}  // namespace
}  // namespace rayfield::density
