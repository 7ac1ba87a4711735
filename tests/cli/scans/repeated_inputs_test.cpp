#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/cli/lane_cloud.h"
#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using testing::HasSubstr;

/// The same rays given to `add` twice, on purpose or not.
class RepeatedInputs : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(rayfield({"init", store(), "--crs", "EPSG:32632"}).exit_code, 0);
    write_file(cloud(), lane_cloud(50));
  }
  Outcome add(std::vector<std::string> files, const std::string& date) {
    files.insert(files.begin(), {"add", store()});
    files.insert(files.end(), {"--date", date, "--no-align"});
    return rayfield(files);
  }
  std::string store() const { return folder_.path("block"); }
  std::string cloud() const { return folder_.path("lane.ply"); }
  Folder folder_;
};

TEST_F(RepeatedInputs, OfOneScanAreRefused) {
  const Outcome twice = add({cloud(), cloud()}, "2021-05-01");
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.err, HasSubstr("lane.ply: it is given twice; give each file once"));
  std::filesystem::copy_file(cloud(), folder_.path("copy.ply"));
  const Outcome copy = add({cloud(), folder_.path("copy.ply")}, "2021-05-01");
  EXPECT_EQ(copy.exit_code, 2);
  EXPECT_THAT(copy.err, HasSubstr("it has the same content as " + cloud()));
  EXPECT_EQ(add({cloud()}, "2021-05-01").exit_code, 0);
}

TEST_F(RepeatedInputs, OfAnotherDateAreSaid) {
  ASSERT_EQ(add({cloud()}, "2021-05-01").exit_code, 0);
  const Outcome again = add({cloud()}, "2021-06-01");
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.err, HasSubstr("lane.ply was added as 2021-05-01 before"));
  const Outcome replaced = rayfield({"add", store(), cloud(), "--date", "2021-06-01", "--no-align", "--overwrite"});
  EXPECT_THAT(replaced.err, HasSubstr("lane.ply was added as 2021-05-01 before"));
  ASSERT_EQ(rayfield({"remove", store(), "2021-05-01"}).exit_code, 0);
  EXPECT_THAT(rayfield({"add", store(), cloud(), "--date", "2021-06-01", "--no-align", "--overwrite"}).err,
              testing::Not(HasSubstr("was added as")));
}

}  // namespace
}  // namespace rayfield::test
