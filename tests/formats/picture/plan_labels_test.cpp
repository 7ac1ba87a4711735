#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "rayfield/formats/picture.h"
#include "tests/formats/png_image.h"
#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

using testing::Image;
using testing::read_png;
using testing::TemporaryFolder;

/// Widths of the runs of columns in which there is something magenta: of labels that do not touch, one each.
std::vector<int> magenta_runs(const Image& image) {
  std::vector<int> runs;
  bool inside = false;
  for (int x = 0; x < image.width; ++x) {
    bool any = false;
    for (int y = 0; y < image.height; ++y) {
      const Rgba& p = image.at(x, y);
      any = any || (p.r > 200 && p.g < 80 && p.b > 200);
    }
    if (any && !inside) runs.push_back(0);
    if (any) ++runs.back();
    inside = any;
  }
  return runs;
}

/// A map of 60 m from west to east with a label of one figure every `spacing_m`.
std::vector<int> labels_at(double spacing_m, std::size_t count) {
  const TemporaryFolder folder;
  const RasterProduct raster{"plan_density", "m2/m2", "", Grid2<float>({276100, 6099900}, 0.5, 120, 60, 1.0F)};
  PlanOverlay overlay;
  for (std::size_t i = 0; i < count; ++i) {
    const TextStyle style{20, {255, 0, 255, 255}, true, Align::middle, Align::middle};
    overlay.labels.push_back({{276102 + spacing_m * static_cast<double>(i), 6099915}, "8", style});
  }
  EXPECT_TRUE(write_plan_picture(raster, overlay, folder / "p.png"));
  return magenta_runs(read_png(folder / "p.png"));
}

TEST(PlanLabels, AreAllShownWhereTheyHaveRoom) { EXPECT_EQ(labels_at(6, 9).size(), 9U); }

TEST(PlanLabels, OfRowsCloseTogetherAreSoManyAsDoNotTouch) {
  const std::vector<int> runs = labels_at(0.5, 100);
  EXPECT_TRUE(runs.size() == 50 || runs.size() == 21 || runs.size() == 11) << runs.size() << " labels";
  const auto [narrowest, widest] = std::minmax_element(runs.begin(), runs.end());
  EXPECT_LE(*widest, *narrowest + 2) << "some lie upon each other";
}

}  // namespace
}  // namespace rayfield::formats
