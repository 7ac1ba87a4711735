#include <gmock/gmock.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>

#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

constexpr int kMostPoints = 2000;

struct Outcome {
  bool killed = false;
  int code = -1;
  std::string message;
};

// Runs the helper with a fault planned ("" = none).
Outcome run_writer(const fs::path& store, const std::string& what, const std::string& fault) {
  int output[2];
  if (::pipe(output) != 0) throw std::runtime_error("no pipe");
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(output[1], STDERR_FILENO);
    ::close(output[0]), ::close(output[1]);
    ::setenv("SOURCE_DATE_EPOCH", "1549843200", 1);
    if (fault.empty()) {
      ::unsetenv("RAYFIELD_FAULT");
    } else {
      ::setenv("RAYFIELD_FAULT", fault.c_str(), 1);
    }
    ::execl(RAYFIELD_FAULT_WRITER, RAYFIELD_FAULT_WRITER, store.c_str(), what.c_str(), nullptr);
    ::_exit(127);
  }
  ::close(output[1]);
  Outcome outcome;
  std::array<char, 4096> buffer{};
  for (ssize_t n = 0; (n = ::read(output[0], buffer.data(), buffer.size())) > 0;)
    outcome.message.append(buffer.data(), static_cast<std::size_t>(n));
  ::close(output[0]);
  int status = 0;
  if (::waitpid(child, &status, 0) != child) throw std::runtime_error("no child");
  outcome.killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
  if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
  return outcome;
}

// Flushing costs milliseconds on a disk and nothing in memory, and these tests flush some ten thousand times.
fs::path quick_folder() {
  const fs::path memory = "/dev/shm";
  return ::access(memory.c_str(), W_OK) == 0 ? memory : fs::temp_directory_path();
}

class StoreFault : public ::testing::TestWithParam<const char*> {
 protected:
  // Makes the store ready for the step under test, and a store on which it ran undisturbed.
  void SetUp() override {
    if (std::string(GetParam()) == "derive") {
      ASSERT_EQ(run_writer(folder_.path() / "start", "add", "").code, 0);
    }
    copy_start("undisturbed");
    const Outcome outcome = run_writer(folder_.path() / "undisturbed", GetParam(), "");
    ASSERT_EQ(outcome.code, 0) << outcome.message;
    wanted_ = contents(folder_.path() / "undisturbed");
    ASSERT_GT(wanted_.size(), 3U);
  }

  fs::path copy_start(const std::string& name) {
    const fs::path path = folder_.path() / name;
    fs::remove_all(path);
    if (fs::exists(folder_.path() / "start")) fs::copy(folder_.path() / "start", path, fs::copy_options::recursive);
    return path;
  }

  // After the disturbance: what readers see is whole, the same command succeeds, and the bytes are those wanted.
  void expect_recovery(const fs::path& path, const std::string& fault) {
    if (fs::exists(path / "store.json")) {
      const auto store = Store::open(path);
      ASSERT_TRUE(store) << fault << ": " << store.error().line();
      EXPECT_TRUE(damage_of(*store).empty()) << fault;
    }
    const Outcome again = run_writer(path, GetParam(), "");
    ASSERT_EQ(again.code, 0) << fault << ": " << again.message;
    EXPECT_EQ(contents(path), wanted_) << fault;
    EXPECT_TRUE(damage_of(Store::open(path).value()).empty()) << fault;
  }

  ScratchFolder folder_{quick_folder()};
  std::map<std::string, std::string> wanted_;
};

TEST_P(StoreFault, AKillAtAnyPointIsHealedByTheSameCommand) {
  int points = 0;
  for (int n = 1; n < kMostPoints; ++n) {
    const std::string fault = "*:" + std::to_string(n) + ":kill";
    const fs::path path = copy_start("victim");
    const Outcome outcome = run_writer(path, GetParam(), fault);
    if (!outcome.killed) {
      ASSERT_EQ(outcome.code, 0) << fault << ": " << outcome.message;
      break;
    }
    ++points;
    expect_recovery(path, fault);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(points, 15) << "the writer passes many points";
  EXPECT_LT(points, kMostPoints - 1);
}

TEST_P(StoreFault, AFullDiskAtAnyPointIsAClearErrorAndHealedByTheSameCommand) {
  int points = 0;
  for (int n = 1; n < kMostPoints; ++n) {
    const std::string fault = "*:" + std::to_string(n) + ":enospc";
    const fs::path path = copy_start("victim");
    const Outcome outcome = run_writer(path, GetParam(), fault);
    ASSERT_FALSE(outcome.killed);
    if (outcome.code == 0) break;
    ++points;
    EXPECT_EQ(outcome.code, static_cast<int>(ErrorCode::resources)) << fault << ": " << outcome.message;
    EXPECT_EQ(std::count(outcome.message.begin(), outcome.message.end(), '\n'), 1) << outcome.message;
    EXPECT_THAT(outcome.message, ::testing::HasSubstr("No space left on device"));
    expect_recovery(path, fault);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(points, 15);
}

TEST_P(StoreFault, EveryKindOfPointIsPassed) {
  for (const char* name : {"lock", "create", "allocate", "write", "fsync", "close", "reopen", "rename", "mkdir", "link",
                           "fsync-directory"}) {
    const Outcome outcome = run_writer(copy_start("victim"), GetParam(), std::string(name) + ":1:kill");
    EXPECT_TRUE(outcome.killed) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Steps, StoreFault, ::testing::Values("add", "derive"));

TEST(StoreFaultLeftovers, TemporaryFilesOfAKilledWriterAreGoneAfterTheNextOne) {
  ScratchFolder folder;
  const fs::path path = folder.path() / "block";
  ASSERT_TRUE(run_writer(path, "add", "fsync:2:kill").killed);
  EXPECT_FALSE(fs::is_empty(path / "tmp"));
  ASSERT_EQ(run_writer(path, "add", "").code, 0);
  EXPECT_TRUE(fs::is_empty(path / "tmp"));
}

TEST(StoreFaultSpill, AWriterThatDiesOrFindsTheDiskFullWhileItPutsRaysAsideIsHealed) {
  ScratchFolder folder;
  ASSERT_EQ(run_writer(folder.path() / "undisturbed", "scatter", "").code, 0);
  const auto wanted = contents(folder.path() / "undisturbed");
  const fs::path path = folder.path() / "victim";
  EXPECT_TRUE(run_writer(path, "scatter", "spill:1:kill").killed);
  const Outcome full = run_writer(path, "scatter", "spill:3:enospc");
  EXPECT_EQ(full.code, static_cast<int>(ErrorCode::resources)) << full.message;
  EXPECT_TRUE(fs::is_empty(path / "tmp"));
  EXPECT_EQ(run_writer(path, "scatter", "").code, 0);
  EXPECT_TRUE(contents(path) == wanted);
}

TEST(StoreFaultLeftovers, GcFreesWhatAKilledWriterLeft) {
  ScratchFolder folder;
  const fs::path path = folder.path() / "block";
  ASSERT_TRUE(run_writer(path, "add", "link:2:kill").killed);
  Store store = Store::open(path).value();
  EXPECT_GT(store.gc(false).value(), 0U);
  EXPECT_TRUE(fs::is_empty(path / "tmp"));
  EXPECT_TRUE(fs::is_empty(path / "scans"));
  EXPECT_EQ(run_writer(path, "add", "").code, 0);
}

}  // namespace
}  // namespace rayfield::tile::testing
