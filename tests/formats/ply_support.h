#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "rayfield/formats/ply_reader.h"
#include "tests/formats/bag_bytes.h"

/// What the tests of ray clouds share.
namespace rayfield::formats {

using namespace bytes;

inline constexpr const char* kStandardProperties =
    "property double x\nproperty double y\nproperty double z\nproperty double time\n"
    "property float nx\nproperty float ny\nproperty float nz\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";

struct ReadCloud {
  RayBatch rays;
  std::vector<std::string> warnings;
};

inline ReadCloud read_all(const std::string& content, const PlyReadOptions& options = {},
                          std::size_t batch_rays = 1000) {
  const TemporaryFile file(content, ".ply");
  ReadCloud out;
  auto reader = PlyReader::open(file.path(), options);
  if (!reader) {
    ADD_FAILURE() << reader.error().line();
    return out;
  }
  RayBatch batch;
  for (;;) {
    const auto count = (*reader)->read(batch, batch_rays);
    if (!count) ADD_FAILURE() << count.error().line();
    if (!count || *count == 0) break;
    EXPECT_LE(*count, batch_rays);
    for (std::size_t i = 0; i < *count; ++i) {
      out.rays.push(batch.origin[i], batch.end[i], batch.time_s[i], batch.intensity[i], batch.hit[i] != 0);
    }
  }
  out.warnings = (*reader)->warnings();
  return out;
}

}  // namespace rayfield::formats
