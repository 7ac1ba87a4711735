#include "rayfield/tile/tile_reader.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

TEST(TileReader, AReaderKeepsItsSnapshotWhileAnotherIsPublished) {
  ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  ASSERT_TRUE(add(store, simulated_drive(2000)));
  const Snapshot pinned = *store.latest();
  AddOptions options = add_options();
  options.overwrite = true;
  ASSERT_TRUE(add(store, simulated_drive(3000, 7), options));
  std::uint64_t segments = 0;
  for (const TileEntry& tile : pinned.scans.at(0).tiles) segments += read_tile(store, tile).size();
  EXPECT_GE(segments, 2000U);
}

TEST(TileReader, ChunksOfOneTileAreReadByManyThreads) {
  ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  RayBatch rays = scattered_rays(400000, 15);
  ASSERT_TRUE(add(store, rays));
  const Snapshot snapshot = *store.latest();
  for (const TileEntry& tile : snapshot.scans.at(0).tiles) {
    const SegmentBatch whole = read_tile(store, tile);
    const auto reader = store.open_tile(tile);
    ASSERT_TRUE(reader);
    std::vector<SegmentBatch> chunks(reader->chunk_count());
    std::vector<std::jthread> threads;
    std::atomic<int> failures{0};
    for (std::size_t c = 0; c < chunks.size(); ++c)
      threads.emplace_back([&, c] { failures += reader->read_chunk(c, chunks[c]) ? 0 : 1; });
    threads.clear();
    EXPECT_EQ(failures, 0);
    std::size_t first = 0;
    for (const SegmentBatch& chunk : chunks) {
      for (std::size_t i = 0; i < chunk.size(); i += 501) ASSERT_EQ(chunk.exit[i], whole.exit[first + i]);
      first += chunk.size();
    }
    EXPECT_EQ(first, whole.size());
  }
}

TEST(TileReader, HitsAreThoseOfTheChunks) {
  ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  ASSERT_TRUE(add(store, scattered_rays(20000, 16)));
  std::size_t hits = 0, others = 0, in_margins = 0;
  const Snapshot snapshot = *store.latest();
  for (const TileEntry& tile : snapshot.scans.at(0).tiles) {
    const auto reader = store.open_tile(tile);
    ASSERT_TRUE(reader);
    for (std::size_t c = 0; c < reader->chunk_count(); ++c) {
      SegmentBatch segments;
      HitBatch alone;
      ASSERT_TRUE(reader->read_chunk(c, segments));
      ASSERT_TRUE(reader->read_hits(c, alone));
      std::size_t next = 0;
      for (std::size_t i = 0; i < segments.size(); ++i) {
        if ((segments.flags[i] & kHit) == 0) {
          ++others;
          continue;
        }
        ASSERT_LT(next, alone.size());
        EXPECT_EQ(alone.end[next], segments.exit[i]);
        EXPECT_EQ(alone.flags[next++], segments.flags[i]);
        in_margins += (segments.flags[i] & kEndsHere) == 0 ? 1U : 0U;
      }
      EXPECT_EQ(next, alone.size());
      hits += next;
    }
  }
  EXPECT_GT(hits, 0U);
  EXPECT_GT(others, 0U);
  EXPECT_GT(in_margins, 0U);
}

}  // namespace
}  // namespace rayfield::tile::testing
