#pragma once

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "rayfield/formats/style.h"

/// Pictures read back with GDAL.
namespace rayfield::formats::testing {

/// A decoded PNG.
struct Image {
  int width = 0, height = 0;
  std::vector<Rgba> pixels;
  const Rgba& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

inline Image read_png(const std::string& path) {
  GDALAllRegister();
  Image image;
  GDALDataset* dataset = GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY);
  if (dataset == nullptr) return image;
  image.width = dataset->GetRasterXSize();
  image.height = dataset->GetRasterYSize();
  image.pixels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  const int bands = dataset->GetRasterCount();
  EXPECT_EQ(
      dataset->RasterIO(GF_Read, 0, 0, image.width, image.height, image.pixels.data(), image.width, image.height,
                        GDT_Byte, bands, nullptr, sizeof(Rgba), static_cast<GSpacing>(image.width) * 4, 1, nullptr),
      CE_None);
  GDALClose(dataset);
  return image;
}

/// Pixels of exactly one colour: number, centroid and bounding box.
struct Blob {
  int count = 0, low_x = 1 << 30, low_y = 1 << 30, high_x = -1, high_y = -1;
  double x = 0, y = 0;
};
/// `share`: of the width that is looked at, from the left.
inline Blob find(const Image& image, const Rgba& color, double share = 1) {
  Blob blob;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < share * image.width; ++x) {
      const Rgba& p = image.at(x, y);
      if (p.r != color.r || p.g != color.g || p.b != color.b) continue;
      ++blob.count;
      blob.x += x + 0.5, blob.y += y + 0.5;
      blob.low_x = std::min(blob.low_x, x), blob.high_x = std::max(blob.high_x, x);
      blob.low_y = std::min(blob.low_y, y), blob.high_y = std::max(blob.high_y, y);
    }
  }
  if (blob.count > 0) blob.x /= blob.count, blob.y /= blob.count;
  return blob;
}

}  // namespace rayfield::formats::testing
