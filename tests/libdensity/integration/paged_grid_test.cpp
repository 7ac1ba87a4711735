#include "libdensity/integration/paged_grid.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <vector>

namespace rayfield::density {
namespace {

std::filesystem::path folder() { return std::filesystem::temp_directory_path(); }

TEST(PagedGrid, HoldsWhatAGridInMemoryHoldsHoweverFewPagesThereAreRoomFor) {
  constexpr int kNx = 300, kNy = 200;  // not whole pages
  for (const std::size_t pages : {1U, 3U, 1000U}) {
    PagedGrid<double> grid(kNx, kNy, pages * PagedGrid<double>::kPageBytes, folder());
    std::vector<double> expected(std::size_t{kNx} * kNy, 0);
    std::mt19937 random(3);
    for (int i = 0; i < 3000; ++i) {
      const int x = static_cast<int>(random() % kNx), y = static_cast<int>(random() % 130);  // no page above 192
      const auto cell = grid.at(x, y);
      ASSERT_TRUE(cell.has_value());
      **cell += i, expected[static_cast<std::size_t>(y) * kNx + static_cast<std::size_t>(x)] += i;
    }
    std::vector<int> visits(expected.size(), 0);
    for (int round = 0; round < 2; ++round)
      for (int band = 0; band < grid.bands(); ++band)
        ASSERT_TRUE(grid.visit_band(band, [&](int x, int y, double value) {
          const std::size_t i = static_cast<std::size_t>(y) * kNx + static_cast<std::size_t>(x);
          EXPECT_EQ(value, expected[i]);
          ++visits[i];
        }));
    for (std::size_t i = 0; i < visits.size(); ++i)
      ASSERT_EQ(visits[i], i < std::size_t{192} * kNx ? 2 : 0) << "cells of pages that nothing was asked of";
  }
}

TEST(PagedGrid, ASecondRoundOfChangesIsKeptToo) {
  PagedGrid<int> grid(128, 64, 1, folder());
  for (int round = 0; round < 3; ++round)
    for (const int x : {5, 100}) ++**grid.at(x, 7);
  EXPECT_EQ(**grid.at(5, 7), 3);
  EXPECT_EQ(**grid.at(100, 7), 3);
}

TEST(PagedGrid, ADiskThatTakesNothingIsAnErrorAndWhatIsInMemoryStays) {
  PagedGrid<int> grid(128, 64, 1, "/nonexistent");
  **grid.at(5, 7) = 4;
  EXPECT_EQ(grid.at(100, 7).error().code, ErrorCode::resources);
  EXPECT_EQ(**grid.at(5, 7), 4);
}

}  // namespace
}  // namespace rayfield::density
