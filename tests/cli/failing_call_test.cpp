#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using ::testing::HasSubstr;

// What the program says and ends with where one call into the system fails (tests/fault/failing_call.cpp).
Outcome with_failing_call(const std::vector<std::string>& arguments, const std::string& call,
                          const std::string& path_end, int from, int error) {
  return rayfield(arguments, {{"LD_PRELOAD", RAYFIELD_FAILING_CALL_LIBRARY},
                              {"RAYFIELD_FAILING_CALL",
                               call + " " + path_end + " " + std::to_string(from) + " " + std::to_string(error)}});
}

// A store of two snapshots, without a scan: a new name of the farm is one.
class FailingCall : public ::testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer has to be the first library";
#endif
    ASSERT_EQ(rayfield({"init", store_, "--crs", "EPSG:32632"}).exit_code, 0);
    for (const char* farm : {"A", "B"}) {
      const Outcome named = rayfield({"registry", "rename", store_, "--farm", farm});
      ASSERT_EQ(named.exit_code, 0) << named.err;
    }
  }
  void expect_resources(const Outcome& run) const {
    EXPECT_EQ(run.exit_code, 5) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr("rayfield: "));
  }
  Folder work_;
  const std::string store_ = work_.path("block");
};

TEST_F(FailingCall, NoneIsMadeToFailWithoutBeingAskedTo) {
  EXPECT_EQ(with_failing_call({"status", store_}, "none", "x", 1, EIO).exit_code, 0);
}

// A listing that ends early would be a store whose newest snapshot is an older one.
TEST_F(FailingCall, SnapshotsThatCannotAllBeListedAreNoOlderStore) {
  for (const int from : {1, 2, 3, 4})
    expect_resources(with_failing_call({"status", store_}, "readdir", "/snapshots", from, EIO));
}

TEST_F(FailingCall, AStoreThatCannotBeLookedAtIsNotMissing) {
  expect_resources(with_failing_call({"status", store_}, "stat", "/block", 1, EIO));
  expect_resources(with_failing_call({"status", store_}, "stat", "/store.json", 1, EIO));
}

TEST_F(FailingCall, NoMemoryForTheLockIsNoDamage) {
  expect_resources(with_failing_call({"registry", "rename", store_, "--farm", "C"}, "fstat", "/lock", 1, ENOMEM));
}

// Snapshot 2 names a file of the registry, snapshot 3 another.
TEST_F(FailingCall, FilesOfAnOldSnapshotThatCannotBeLookedAtAreNotGone) {
  ASSERT_EQ(rayfield({"revert", store_, "1"}).exit_code, 0);
  ASSERT_EQ(rayfield({"revert", store_, "2", "--dry-run"}).exit_code, 0);
  expect_resources(with_failing_call({"revert", store_, "2"}, "stat", ".h5", 1, EIO));
}

TEST_F(FailingCall, VerifyTellsADiskThatFailsFromDamage) {
  expect_resources(with_failing_call({"verify", store_}, "readdir", "/snapshots", 2, EIO));
}

}  // namespace
}  // namespace rayfield::test
