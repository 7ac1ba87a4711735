#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "tests/fault/fault_writer.h"
#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

constexpr int kLocked = static_cast<int>(ErrorCode::locked);

std::string date_of(int writer) { return "2019-03-0" + std::to_string(writer + 1); }

// A command that is told of another writer is typed again.
Outcome run_until_free(const fs::path& store, const std::string& what, std::atomic<int>& refusals) {
  for (;;) {
    Outcome outcome = run_writer(store, what, "");
    if (outcome.code != kLocked) return outcome;
    ++refusals;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

// What a reader must find at any moment: snapshots that only go forward, each with all of its files.
class Reader {
 public:
  explicit Reader(const fs::path& path) : store_(Store::open(path).value()), thread_([this] { read(); }) {}
  ~Reader() {
    done_ = true;
    thread_.join();
    EXPECT_GT(reads_, 0);
    EXPECT_THAT(problems_, ::testing::IsEmpty());
  }

 private:
  void read() {
    std::uint64_t last = 0;
    do {
      const auto snapshot = store_.latest();
      if (!snapshot) {
        problems_.push_back(snapshot.error().line());
        return;
      }
      if (snapshot->number < last) problems_.push_back("an older snapshot than before");
      last = snapshot->number;
      for (const FileEntry* file : snapshot->files()) {
        std::error_code error;
        if (fs::file_size(store_.folder() / file->path, error) != file->size || error)
          problems_.push_back("snapshot " + std::to_string(last) + " without " + file->path);
      }
      for (const ScanEntry& scan : snapshot->scans)
        if (!store_.open_tile(scan.tiles.front())) problems_.push_back("a tile of " + scan.scan_id);
      ++reads_;
    } while (!done_ && problems_.empty());
  }
  Store store_;
  std::atomic<bool> done_ = false;
  int reads_ = 0;
  std::vector<std::string> problems_;
  std::thread thread_;
};

TEST(StoreConcurrency, EightWritersAndTwoReadersLoseNothingAndSeeNothingHalf) {
  ScratchFolder folder(quick_folder());
  const fs::path path = folder.path() / "block";
  ASSERT_EQ(run_writer(path, "add", "").code, 0);
  std::atomic<int> refusals = 0, failures = 0;
  {
    const Reader one(path), two(path);
    std::vector<std::thread> writers;
    for (int writer = 0; writer < 8; ++writer)
      writers.emplace_back([&, writer] {
        if (run_until_free(path, "add:" + date_of(writer), refusals).code != 0) ++failures;
      });
    for (std::thread& writer : writers) writer.join();
  }
  EXPECT_EQ(failures, 0);
  const Store store = Store::open(path).value();
  const Snapshot latest = *store.latest();
  EXPECT_EQ(latest.number, 9U) << "a snapshot for every writer";
  ASSERT_EQ(latest.scans.size(), 9U);
  for (int writer = 0; writer < 8; ++writer) EXPECT_NE(latest.find_scan(date_of(writer)), nullptr) << writer;
  EXPECT_TRUE(damage_of(store).empty());
  EXPECT_TRUE(fs::is_empty(path / "tmp"));
}

TEST(StoreConcurrency, RemovingRevertingAndAddingAtOnceLeavesAWholeHistory) {
  ScratchFolder folder(quick_folder());
  const fs::path path = folder.path() / "block";
  ASSERT_EQ(run_writer(path, "add", "").code, 0);
  std::atomic<int> refusals = 0, failures = 0;
  {
    const Reader reader(path);
    std::vector<std::thread> writers;
    for (const char* what : {"add:2019-03-01", "remove", "add:2019-03-02", "revert", "derive"})
      writers.emplace_back([&, what] {
        const int code = run_until_free(path, what, refusals).code;
        // What is derived from a scan that was removed just before has nowhere to go.
        if (code != 0 && !(std::string(what) == "derive" && code == static_cast<int>(ErrorCode::usage))) ++failures;
      });
    for (std::thread& writer : writers) writer.join();
  }
  EXPECT_EQ(failures, 0);
  const Store store = Store::open(path).value();
  const auto history = store.history();
  ASSERT_TRUE(history) << history.error().line();
  for (std::size_t i = 0; i < history->size(); ++i) {
    EXPECT_EQ((*history)[i].number, i + 1);
    EXPECT_EQ((*history)[i].parent, i);
  }
  EXPECT_TRUE(damage_of(store).empty());
}

}  // namespace
}  // namespace rayfield::tile::testing
