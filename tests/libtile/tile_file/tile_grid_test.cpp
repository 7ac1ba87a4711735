#include <gmock/gmock.h>

#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

using Eigen::Vector3d;

constexpr double kHalfUnit = 0.5e-4 + 1e-9;  // rounding of a coordinate to 0.1 mm, and of the arithmetic

// Each ray has its own whole second as time, by which its segments are recognised.
struct Piece {
  TileIndex tile;
  Vector3d entry, exit;
  std::uint16_t intensity;
  std::uint8_t flags;
};
using Pieces = std::map<std::size_t, std::vector<Piece>>;

class TileClipping : public ::testing::Test {
 protected:
  void give(const Vector3d& origin, const Vector3d& end, bool hit = true) {
    rays_.push(origin, end, static_cast<double>(rays_.size()), 7, hit);
  }

  Pieces tiled(double margin_m) {
    StoreConfig config = test_config();
    config.tile_margin_m = margin_m;
    Store store = make_store(folder_.path() / ("margin" + std::to_string(margin_m)), config);
    const auto report = add(store, rays_);
    EXPECT_TRUE(report) << report.error().line();
    EXPECT_EQ(report->ray_count, rays_.size());
    Pieces pieces;
    const Snapshot snapshot = *store.latest();
    for (const TileEntry& tile : snapshot.scans.at(0).tiles) {
      const SegmentBatch segments = read_tile(store, tile);
      for (std::size_t i = 0; i < segments.size(); ++i)
        pieces[static_cast<std::size_t>(std::llround(segments.time_s[i]))].push_back(
            {tile.index, segments.entry[i], segments.exit[i], segments.intensity[i], segments.flags[i]});
    }
    return pieces;
  }

  void expect_flags_once(const Pieces& pieces) {
    for (std::size_t r = 0; r < rays_.size(); ++r) {
      int starts = 0, ends = 0;
      for (const Piece& piece : pieces.at(r)) {
        starts += (piece.flags & kStartsHere) != 0 ? 1 : 0;
        ends += (piece.flags & kEndsHere) != 0 ? 1 : 0;
      }
      EXPECT_EQ(starts, 1) << "ray " << r;
      EXPECT_EQ(ends, 1) << "ray " << r;
    }
  }

  // Without margin, tiles share out each ray's length.
  void expect_whole_length(const Pieces& pieces) {
    for (std::size_t r = 0; r < rays_.size(); ++r) {
      double sum = 0;
      for (const Piece& piece : pieces.at(r)) sum += (piece.exit - piece.entry).norm();
      EXPECT_NEAR(sum, (rays_.end[r] - rays_.origin[r]).norm(), 2e-4) << "ray " << r;
    }
  }

  void give_special_rays() {
    const double x = 25.0 * 11047, y = 25.0 * 243997, z = 80;
    give({x + 5, y, z}, {x + 60, y, z});                       // along a border, over two corners
    give({x, y + 60, z}, {x, y + 5, z});                       // along a border, southwards
    give({x - 10, y - 10, z}, {x + 40, y + 40, z + 3});        // through corners
    give({x + 10, y - 10, z}, {x - 10, y + 10, z});            // through a corner, the other diagonal
    give({x, y + 3, z}, {x - 7, y + 4, z});                    // starts on a border and leaves its tile at once
    give({x, y + 3, z}, {x + 7, y + 4, z});                    // starts on a border and stays
    give({x, y, z}, {x + 1, y - 1, z});                        // starts on a corner
    give({x + 7, y + 4, z}, {x, y + 3, z});                    // ends on a border
    give({x + 3, y + 3, z}, {x + 3, y + 3, z});                // zero length
    give({x, y, z}, {x, y, z});                                // zero length on a corner
    give({x + 3, y + 3, z}, {x + 3, y + 3, z + 40});           // vertical
    give({x + 25, y + 3, z + 40}, {x + 25, y + 3, z});         // vertical on a border
    give({x + 12, y + 12, z}, {x + 12 + 32, y + 12 + 24, z});  // 40 m
    give({-1, -1, -5}, {-30, -60, -5});                        // negative coordinates
    give({-25, -25, 0}, {-25, -25, 3});                        // negative, on a corner
    give({10, -0.00003, 0}, {10, 30, 0});                      // rounds onto the border
    give({0, 0, 0}, {300, 400, 10});                           // 500 m
    give({0, 0, 0}, {-1100, 7, 10});                           // long and flat
    give({3, 0, 0}, {4, -1100, 10}, false);                    // long and steep
  }

  void give_random_rays() {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-60.0, 60.0), length(-40.0, 40.0);
    for (int i = 0; i < 2000; ++i) {
      const Vector3d origin(place(random), place(random), place(random));
      give(origin, origin + Vector3d(length(random), length(random), 0.3 * length(random)), i % 3 != 0);
    }
  }

  ScratchFolder folder_;
  RayBatch rays_;
};

TEST_F(TileClipping, RaysInSpecialPlacesKeepTheirWholeLength) {
  give_special_rays();
  const Pieces pieces = tiled(0.0);
  expect_whole_length(pieces);
  expect_flags_once(pieces);
}

TEST_F(TileClipping, RandomRaysKeepTheirWholeLength) {
  give_random_rays();
  const Pieces pieces = tiled(0.0);
  expect_whole_length(pieces);
  expect_flags_once(pieces);
}

TEST_F(TileClipping, FlagsStandOnceOverAllTilesWithAMarginToo) {
  give_special_rays();
  give_random_rays();
  expect_flags_once(tiled(0.25));
}

TEST_F(TileClipping, EveryPointOfARayInAWidenedTileIsOnItsSegmentAndNoOther) {
  give_special_rays();
  give_random_rays();
  const double margin = 0.25, size = 25.0;
  const Pieces pieces = tiled(margin);
  for (std::size_t r = 0; r < rays_.size(); ++r) {
    const Vector3d origin = rays_.origin[r], along = rays_.end[r] - rays_.origin[r];
    const double length = along.norm();
    std::map<TileIndex, const Piece*> by_tile;
    for (const Piece& piece : pieces.at(r)) {
      EXPECT_TRUE(by_tile.emplace(piece.tile, &piece).second) << "two segments of ray " << r << " in one tile";
    }
    // Samples, each in up to four widened tiles; those within a millimetre of a rim say nothing.
    for (int s = 0; s <= 400; ++s) {
      const double t = s / 400.0;
      const Vector3d p = origin + t * along;
      std::set<TileIndex> holding;
      for (const double dx : {-margin, margin}) {
        for (const double dy : {-margin, margin})
          holding.insert(
              {static_cast<int>(std::floor((p.x() + dx) / size)), static_cast<int>(std::floor((p.y() + dy) / size))});
      }
      for (const TileIndex& tile : holding) {
        const double u = p.x() - tile.ix * size, v = p.y() - tile.iy * size;
        const double depth = std::min({u + margin, size + margin - u, v + margin, size + margin - v});
        if (depth < 1e-3) continue;
        ASSERT_TRUE(by_tile.contains(tile)) << "ray " << r << " at " << t;
        const Piece& piece = *by_tile[tile];
        if (length == 0) continue;
        const double from = (piece.entry - origin).dot(along) / length, to = (piece.exit - origin).dot(along) / length;
        EXPECT_GE(t * length, from - 2e-4) << "ray " << r;
        EXPECT_LE(t * length, to + 2e-4) << "ray " << r;
      }
    }
    for (const Piece& piece : pieces.at(r)) {
      for (const Vector3d& p : {piece.entry, piece.exit}) {
        const double u = p.x() - piece.tile.ix * size, v = p.y() - piece.tile.iy * size;
        EXPECT_GE(std::min(u, v), -margin - 1e-8);
        EXPECT_LE(std::max(u, v), size + margin + 1e-8);
        if (length > 0) {
          EXPECT_LE((p - origin).cross(along).norm() / length, 2e-4) << "off the line of ray " << r;
        }
      }
    }
  }
}

TEST_F(TileClipping, OriginAndEndComeBackToATenthOfAMillimetreAndEqualInAllTiles) {
  give_random_rays();
  const Pieces pieces = tiled(5.0);
  for (std::size_t r = 0; r < rays_.size(); ++r) {
    std::optional<Vector3d> origin, end;
    for (const Piece& piece : pieces.at(r)) {
      if ((piece.flags & kStartsHere) != 0) origin = piece.entry;
      if ((piece.flags & kEndsHere) != 0) end = piece.exit;
    }
    ASSERT_TRUE(origin && end);
    EXPECT_LE((*origin - rays_.origin[r]).cwiseAbs().maxCoeff(), kHalfUnit);
    EXPECT_LE((*end - rays_.end[r]).cwiseAbs().maxCoeff(), kHalfUnit);
    for (const Piece& piece : pieces.at(r)) {
      if ((piece.entry - *origin).norm() < 1e-6) {
        EXPECT_EQ(piece.entry, *origin);
      }
      if ((piece.exit - *end).norm() < 1e-6) {
        EXPECT_EQ(piece.exit, *end);
      }
    }
  }
}

TEST_F(TileClipping, AHitIsInEveryTileWhoseMarginReachesItAndEndsInOneOfThem) {
  give({10, 10, 0}, {24.9, 12, 0});         // ends in tile 0, in the margin of tile 1
  give({10, 10, 0}, {25.1, 12, 0});         // ends in tile 1, in the margin of tile 0
  give({10, 10, 0}, {24.9, 12, 0}, false);  // no hit
  give({10, 10, 0}, {24.0, 12, 0});         // out of the margin's reach
  const Pieces pieces = tiled(0.25);
  const auto flags = [&](std::size_t ray, int ix) {
    for (const Piece& piece : pieces.at(ray)) {
      if (piece.tile.ix == ix) return static_cast<int>(piece.flags);
    }
    return -1;
  };
  EXPECT_EQ(flags(0, 0), kHit | kStartsHere | kEndsHere);
  EXPECT_EQ(flags(0, 1), kHit);
  EXPECT_EQ(flags(1, 0), kHit | kStartsHere);
  EXPECT_EQ(flags(1, 1), kHit | kEndsHere);
  EXPECT_EQ(flags(2, 0), kStartsHere | kEndsHere);
  EXPECT_EQ(flags(2, 1), 0);
  EXPECT_EQ(flags(3, 0), kHit | kStartsHere | kEndsHere);
  EXPECT_EQ(flags(3, 1), -1);
}

TEST_F(TileClipping, IntensityStandsWithTheHitOnly) {
  give_random_rays();
  for (const auto& [ray, list] : tiled(0.25)) {
    for (const Piece& piece : list) EXPECT_EQ(piece.intensity, (piece.flags & kHit) != 0 ? 7 : 0) << "ray " << ray;
  }
}

}  // namespace
}  // namespace rayfield::tile::testing
