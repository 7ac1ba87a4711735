#include "rayfield/core/grid3.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

namespace rayfield {
namespace {

TEST(Shape3, EveryPlaceHasAnIndexOfItsOwnAndTheThirdRunsFastest) {
  const Shape3 shape{3, 4, 5};
  std::set<std::size_t> indices;
  std::size_t next = 0;
  for (int i = 0; i < shape.ni; ++i)
    for (int j = 0; j < shape.nj; ++j)
      for (int k = 0; k < shape.nk; ++k) {
        EXPECT_EQ(shape.index(i, j, k), next++);
        EXPECT_EQ(shape.column(i, j), shape.index(i, j, k) / 5);
        indices.insert(shape.index(i, j, k));
      }
  EXPECT_EQ(indices.size(), shape.size());
  EXPECT_EQ(shape.columns(), 12U);
}

TEST(Shape3, ProductsDoNotOverflowAnInt) {
  const Shape3 shape{4000, 2000, 1000};
  EXPECT_EQ(shape.size(), std::size_t{8'000'000'000});
  EXPECT_EQ(shape.index(3999, 1999, 999), shape.size() - 1);
}

TEST(Shape3, ContainsTellsPlacesOutsideOnEverySide) {
  const Shape3 shape{2, 2, 2};
  EXPECT_TRUE(shape.contains(1, 1, 1));
  for (const auto& [i, j, k] : {std::array{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}})
    EXPECT_FALSE(shape.contains(i, j, k));
}

TEST(Grid3, HoldsWhatWasPutInEveryPlace) {
  Grid3<int> grid(Shape3{2, 3, 4}, 7);
  EXPECT_EQ(grid.values.size(), 24U);
  grid.at(1, 2, 3) = 5;
  EXPECT_EQ(grid.values.back(), 5);
  EXPECT_EQ(grid.at(0, 0, 0), 7);
}

}  // namespace
}  // namespace rayfield
