// The smallest program on the installed libraries: options of the density, and the CRS of a store.
#include <cstdio>

#include "rayfield/core/map_frame.h"
#include "rayfield/density/density.h"
#include "rayfield/formats/ply_reader.h"
#include "rayfield/tile/tile.h"

int main() {
  const auto crs = rayfield::lookup_projected_crs("EPSG:7854");
  if (!crs) return 1;
  const auto options = rayfield::density::ProcessOptions{}.validate();
  const auto missing = rayfield::tile::Store::open("no-such-store");
  const auto cloud = rayfield::formats::PlyReader::open("no-such-cloud.ply");
  if (missing || cloud || !options) return 1;
  std::printf("%s\n", crs->name.c_str());
  return 0;
}
