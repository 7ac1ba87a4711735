#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "libtile/store/snapshot_log.h"
#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

TEST(Writers, ASecondWriterIsToldThatTheStoreIsLocked) {
  ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  const auto first = store.write_derived();
  ASSERT_TRUE(first);
  EXPECT_EQ(store.write_derived().error().code, ErrorCode::locked);
  EXPECT_EQ(add(store, simulated_drive(10)).error().code, ErrorCode::locked);
  EXPECT_EQ(store.gc(false).error().code, ErrorCode::locked);
  EXPECT_EQ(store.gc(true).value(), 0U) << "looking needs no lock";
}

TEST(Writers, AnotherProcessIsLockedOutUntilTheFirstHasGone) {
  ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  int ready[2], done[2];
  ASSERT_EQ(::pipe(ready), 0);
  ASSERT_EQ(::pipe(done), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto writer = store.write_derived();
    char byte = writer ? 'y' : 'n';
    if (::write(ready[1], &byte, 1) != 1) ::_exit(1);
    if (::read(done[0], &byte, 1) != 1) ::_exit(1);
    ::_exit(0);
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  ASSERT_EQ(byte, 'y');
  EXPECT_EQ(add(store, simulated_drive(10)).error().code, ErrorCode::locked);
  EXPECT_EQ(store.latest()->number, 0U) << "readers never wait";
  ASSERT_EQ(::write(done[1], "x", 1), 1);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(add(store, simulated_drive(10)));
  for (const int fd : {ready[0], ready[1], done[0], done[1]}) ::close(fd);
}

// Where locks do not work (some network folders), the exclusive link still lets nobody's snapshot be lost.
TEST(Writers, PublishersWithoutALockRebaseOnEachOther) {
  ScratchFolder folder;
  const Store store = make_store(folder.path() / "block");
  constexpr int kWriters = 4, kEach = 3;
  std::vector<std::jthread> threads;
  std::atomic<int> failures{0};
  for (int w = 0; w < kWriters; ++w) {
    threads.emplace_back([&, w] {
      for (int k = 0; k < kEach; ++k) {
        const auto published =
            publish(store.folder(), "x", [&](const Snapshot& latest) -> Result<std::optional<Snapshot>> {
              Snapshot next = latest;
              ScanEntry scan;
              scan.scan_id = std::to_string(w) + "-" + std::to_string(k);
              next.scans.push_back(scan);
              return next;
            });
        if (!published) ++failures;
      }
    });
  }
  threads.clear();
  EXPECT_EQ(failures, 0);
  const Snapshot latest = *store.latest();
  EXPECT_EQ(latest.number, static_cast<std::uint64_t>(kWriters * kEach));
  std::set<std::string> ids;
  for (const ScanEntry& scan : latest.scans) ids.insert(scan.scan_id);
  EXPECT_EQ(ids.size(), static_cast<std::size_t>(kWriters * kEach));
  EXPECT_EQ(store.history()->size(), static_cast<std::size_t>(kWriters * kEach));
}

TEST(Writers, AReaderKeepsItsSnapshotWhileAnotherIsPublished) {
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

TEST(Writers, ChunksOfOneTileAreReadByManyThreads) {
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

}  // namespace
}  // namespace rayfield::tile::testing
