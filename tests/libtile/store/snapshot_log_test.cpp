#include "libtile/store/snapshot_log.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

// Where locks do not work (some network folders), the exclusive link still lets nobody's snapshot be lost.
TEST(SnapshotLog, PublishersWithoutALockRebaseOnEachOther) {
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
              scan.date = "2019-02-11";
              scan.scan_id = scan.date + "_" + std::to_string(w) + "-" + std::to_string(k);
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

}  // namespace
}  // namespace rayfield::tile::testing
