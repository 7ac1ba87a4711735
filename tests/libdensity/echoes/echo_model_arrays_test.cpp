#include "libdensity/echoes/echo_model_arrays.h"

#include <gtest/gtest.h>

#include <limits>

namespace rayfield::density {
namespace {

// Each number another one, so that none can stand in another's place.
EchoModel model_of(double lost_share, double per_cosine = 0, double lacking = 0, double unreturned = 0,
                   double mean_weight = 0, bool lacks_misses = false) {
  EchoModel model;
  model.beam = {0.0136, 0.0119, {}};
  model.range_resolution_m = 0.15, model.full_echo = 106, model.full_echo_error = 0.04, model.detection_share = 0.25;
  model.leaf_size_m2 = 0.0078, model.leaf_size_from = LeafSizeFrom::pairs, model.echo_variation = 0.2,
  model.mean_width_m = 0.041;
  model.lost_share = lost_share, model.full_echo_per_cosine = per_cosine;
  model.lacking_share = lacking, model.unreturned_share = unreturned;
  model.mean_echo_weight = mean_weight, model.lacks_downward_misses = lacks_misses;
  return model;
}

void expect_same(const EchoModel& a, const EchoModel& b) {
  EXPECT_EQ(a.beam.diameter_m, b.beam.diameter_m);
  EXPECT_EQ(a.beam.divergence_rad, b.beam.divergence_rad);
  EXPECT_EQ(a.range_resolution_m, b.range_resolution_m);
  EXPECT_EQ(a.full_echo, b.full_echo);
  EXPECT_EQ(a.full_echo_error, b.full_echo_error);
  EXPECT_EQ(a.detection_share, b.detection_share);
  EXPECT_EQ(a.leaf_size_m2, b.leaf_size_m2);
  EXPECT_EQ(a.leaf_size_from, b.leaf_size_from);
  EXPECT_EQ(a.echo_variation, b.echo_variation);
  EXPECT_EQ(a.mean_width_m, b.mean_width_m);
  EXPECT_EQ(a.lost_share, b.lost_share);
  EXPECT_EQ(a.full_echo_per_cosine, b.full_echo_per_cosine);
  EXPECT_EQ(a.lacking_share, b.lacking_share);
  EXPECT_EQ(a.unreturned_share, b.unreturned_share);
  EXPECT_EQ(a.mean_echo_weight, b.mean_echo_weight);
  EXPECT_EQ(a.lacks_downward_misses, b.lacks_downward_misses);
  EXPECT_EQ(a.beam.returns, b.beam.returns);
  EXPECT_EQ(a.resolution_assumed, b.resolution_assumed);
  EXPECT_EQ(a.range_resolution_error_m, b.range_resolution_error_m);
  EXPECT_EQ(a.wood_error, b.wood_error);
  EXPECT_EQ(a.wood_brightness, b.wood_brightness);
  EXPECT_EQ(a.wood_per_side, b.wood_per_side);
  EXPECT_EQ(a.angle_slope, b.angle_slope);
  EXPECT_EQ(a.leaves_per_resolution, b.leaves_per_resolution);
  EXPECT_EQ(a.wood_returned, b.wood_returned);
  ASSERT_EQ(a.leaf_normals.has_value(), b.leaf_normals.has_value());
  if (a.leaf_normals) {
    EXPECT_EQ(a.leaf_normals->value, b.leaf_normals->value);
  }
  if (a.leaf_normals) {
    EXPECT_EQ(a.leaf_normals->error, b.leaf_normals->error);
  }
}

TEST(EchoModelArrays, GiveBackTheModel) {
  for (const EchoModel& model : {model_of(0.044, 60, 0.03, 0.05, 0.2, true), model_of(0.044, -3), model_of(0)}) {
    const auto read = echo_model_from_arrays(arrays_from_echo_model(model));
    ASSERT_TRUE(read) << read.error().line();
    ASSERT_TRUE(*read);
    expect_same(**read, model);
  }
}

TEST(EchoModelArrays, GiveBackWhichEchoTheLidarReports) {
  for (const auto& [name, mode] : kReturnModes) {
    EchoModel model = model_of(0.044);
    model.beam.returns = mode, model.resolution_assumed = mode == ReturnMode::first;
    model.leaves_per_resolution = 0.4;
    tile::ArraySet arrays = arrays_from_echo_model(model);
    const auto read = echo_model_from_arrays(arrays);
    ASSERT_TRUE(read && *read) << name;
    expect_same(**read, model);
    for (const double none : {-1.0, 0.5, 1.5, 4.0}) {
      std::vector<double> numbers = model_numbers(model);
      numbers.at(17) = none;  // the place of what the lidar reports
      arrays.columns["model"] = numbers;
      EXPECT_FALSE(echo_model_from_arrays(arrays)) << none;
    }
  }
}

TEST(EchoModelArrays, GiveBackWhatEchoesHoldOfBareWood) {
  EchoModel model = model_of(0.044);
  for (const double returned : {0.3, 1.0}) {
    model.wood_returned = returned;
    expect_same(**echo_model_from_arrays(arrays_from_echo_model(model)), model);
  }
  for (const double cannot_be : {-0.1, 1.1}) {
    model.wood_returned = cannot_be;
    EXPECT_FALSE(echo_model_from_arrays(arrays_from_echo_model(model))) << cannot_be;
  }
}

TEST(EchoModelArrays, GiveBackHowLeavesAreTurned) {
  EchoModel model = model_of(0.044);
  for (const LnRatio& normals : {LnRatio{-0.2, 0.1}, LnRatio{0, 0.3}, LnRatio{1.3, 0.05}}) {
    model.leaf_normals = normals;
    expect_same(**echo_model_from_arrays(arrays_from_echo_model(model)), model);
  }
  for (const LnRatio& cannot_be : {LnRatio{0.3, -0.1}, LnRatio{3.5, 0.1}}) {
    model.leaf_normals = cannot_be;
    EXPECT_FALSE(echo_model_from_arrays(arrays_from_echo_model(model))) << cannot_be.value;
  }
}

TEST(EchoModelArrays, GiveBackThatTheEchoesDoNotTell) {
  const auto read = echo_model_from_arrays(arrays_from_echo_model(std::nullopt));
  ASSERT_TRUE(read);
  EXPECT_FALSE(*read);
}

TEST(EchoModelArrays, OfOlderVersionsLackTheLastNumbers) {
  EchoModel whole = model_of(0.044, 60, 0.03, 0.05, 0.2, true);
  whole.beam.returns = ReturnMode::strongest, whole.resolution_assumed = true, whole.leaves_per_resolution = 0.4,
  whole.wood_returned = 0.8, whole.leaf_normals = LnRatio{0.4, 0.1}, whole.range_resolution_error_m = 0.03,
  whole.wood_error = 0.05, whole.wood_brightness = 0.6, whole.wood_per_side = 0.18, whole.angle_slope = 0.7;
  std::vector<double> numbers = model_numbers(whole);
  tile::ArraySet arrays = arrays_from_echo_model(std::nullopt);
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  whole.angle_slope = 0;
  expect_same(**echo_model_from_arrays(arrays), whole);
  numbers.resize(numbers.size() - 2);
  arrays.columns["model"] = numbers;
  whole.wood_brightness = 1, whole.wood_per_side = 0;
  expect_same(**echo_model_from_arrays(arrays), whole);
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  whole.wood_error = 0;
  expect_same(**echo_model_from_arrays(arrays), whole);
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  whole.range_resolution_error_m = 0;
  expect_same(**echo_model_from_arrays(arrays), whole);
  numbers.resize(numbers.size() - 2);
  arrays.columns["model"] = numbers;
  whole.leaf_normals.reset();
  expect_same(**echo_model_from_arrays(arrays), whole);
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  whole.wood_returned.reset();
  expect_same(**echo_model_from_arrays(arrays), whole);
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  whole.leaves_per_resolution = 0;
  expect_same(**echo_model_from_arrays(arrays), whole);
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  whole.resolution_assumed = false;
  expect_same(**echo_model_from_arrays(arrays), whole);
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  expect_same(**echo_model_from_arrays(arrays), model_of(0.044, 60, 0.03, 0.05, 0.2, true));
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  expect_same(**echo_model_from_arrays(arrays), model_of(0.044, 60, 0.03, 0.05, 0.2));
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  expect_same(**echo_model_from_arrays(arrays), model_of(0.044, 60, 0.03, 0.05));
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  expect_same(**echo_model_from_arrays(arrays), model_of(0.044, 60, 0.03));
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  expect_same(**echo_model_from_arrays(arrays), model_of(0.044, 60));
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  expect_same(**echo_model_from_arrays(arrays), model_of(0.044));
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  expect_same(**echo_model_from_arrays(arrays), model_of(0));
  numbers.pop_back();
  arrays.columns["model"] = numbers;
  expect_same(**echo_model_from_arrays(arrays), model_of(0));
}

TEST(EchoModelArrays, ThatCannotBeAreRefused) {
  const std::vector<double> good = model_numbers(model_of(0.044));
  std::vector<std::vector<double>> wrong(9, good);
  wrong[0].resize(9);
  wrong[1].push_back(1);
  wrong[2][3] = -1;
  wrong[3][11] = std::numeric_limits<double>::quiet_NaN();
  wrong[4][0] = 0;
  wrong[5][4] = 3;  // where the size of the leaves is from
  wrong[6][13] = 1;
  wrong[7][14] = -0.01;
  wrong[8][15] = 1.01;
  for (const std::vector<double>& numbers : wrong) {
    tile::ArraySet arrays = arrays_from_echo_model(std::nullopt);
    arrays.columns["model"] = numbers;
    const auto read = echo_model_from_arrays(arrays);
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().code, ErrorCode::damaged);
  }
}

}  // namespace
}  // namespace rayfield::density
