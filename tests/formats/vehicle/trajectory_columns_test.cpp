#include "formats/vehicle/trajectory_columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rayfield/formats/trajectory_file.h"
#include "tests/formats/bag_bytes.h"

namespace rayfield::formats {
namespace {

using ::testing::HasSubstr;

Result<TrajectoryFile> read(const std::string& text, const TrajectoryReadOptions& options = {}) {
  const bytes::TemporaryFile file(text, ".csv");
  return read_trajectory(file.path(), options);
}

TEST(TrajectoryColumns, AreFoundByTheirNamesInAnyOrder) {
  const std::vector<std::string> tables = {
      "time,x,y,z\n10,1,2,3\n11,4,5,6\n", "Height;Northing;Easting;GPS Time\r\n3;2;1;10\r\n6;5;4;11\r\n",
      "# crs: EPSG:7854\n\"GPS_Time [s]\", \"Easting [m]\", \"Northing [m]\", \"Altitude (m)\", "
      "note\n10,1,2,3,a\n11,4,5,6,b\n",
      "%time x y z userfields\n10 1 2 3 0\n11 4 5 6 0\n", "\xEF\xBB\xBFt\tx\ty\tz\n10\t1\t2\t3\n11\t4\t5\t6\n"};
  for (const std::string& table : tables) {
    const auto trajectory = read(table);
    ASSERT_TRUE(trajectory) << table << trajectory.error().line();
    ASSERT_EQ(trajectory->poses.size(), 2U) << table;
    EXPECT_EQ(trajectory->poses[1].time_s, 11) << table;
    EXPECT_EQ(trajectory->poses[1].map_from_body.translation, Eigen::Vector3d(4, 5, 6)) << table;
    EXPECT_FALSE(trajectory->has_orientation) << table;
  }
  EXPECT_EQ(read(tables[2])->crs, "EPSG:7854");
}

TEST(TrajectoryColumns, HoldOrientationsWhereAllFourAreNamed) {
  const auto trajectory = read("timestamp,tx,ty,tz,qw,qx,qy,qz\n10,1,2,3,0,0,0,1\n");
  ASSERT_TRUE(trajectory) << trajectory.error().line();
  EXPECT_TRUE(trajectory->has_orientation);
  EXPECT_EQ(trajectory->poses[0].map_from_body.rotation.z(), 1);
  EXPECT_THAT(read("t,x,y,z,qx,qy\n1,2,3,4,5,6\n").error().line(), HasSubstr("line 1: the header names some of qx"));
}

TEST(TrajectoryColumns, OfTumLeaveItsLinesAsStrictAsTheyWere) {
  for (const std::string header :
       {"# t x y z qx qy qz qw\n", "t x y z qx qy qz qw\n", "#timestamp tx ty tz qx qy qz qw\n"}) {
    ASSERT_TRUE(read(header + "1 2 3 4 0 0 0 1\n")) << header;
    EXPECT_THAT(read(header + "1 2 3 4 0 0 0 1 5\n").error().line(), HasSubstr("line 2: not the eight numbers"))
        << header;
  }
}

TEST(TrajectoryColumns, AreNotReadIntoCommentsOrPoses) {
  EXPECT_TRUE(read("# time of the drive, in the morning\n# a, time, of, day\n1 2 3 4 0 0 0 1\n"));
  EXPECT_FALSE(read("# crs: t x y z\n1 2 3 4\n"));
  EXPECT_THAT(read("1 2 3 4 0 0 0 1\ntime x y z\n").error().line(), HasSubstr("line 2: not the eight numbers"));
  EXPECT_THAT(read("a b c d\n1 2 3 4\n").error().line(), HasSubstr("line 1: not the eight numbers"));
}

TEST(TrajectoryColumns, ThatAreMissingAreNamed) {
  EXPECT_THAT(read("time,x,y\n1,2,3\n").error().line(), HasSubstr("line 1: the header names no column of 'height'"));
  EXPECT_THAT(read("time,lat,lon,height\n1,2,3,4\n").error().line(), HasSubstr("its places are in degrees"));
  EXPECT_THAT(read("time,t,x,y,z\n1,1,2,3,4\n").error().line(), HasSubstr("two columns of 'time'"));
  for (const char* line : {"1,2,3", "1,2,3,", "1,2,3,x", "1,2,3,nan", "1;2;3;4", "one,2,3,4"})
    EXPECT_THAT(read(std::string("time,x,y,z\n") + line + "\n").error().line(),
                HasSubstr("line 2: not a number in each column"))
        << line;
  EXPECT_THAT(read("time,x,y,z\n").error().line(), HasSubstr("it holds no poses"));
}

TEST(TrajectoryColumns, DoNotFillTheMemory) {
  const auto trajectory = read("time,x,y,z\n1,0,0,0\n2,0,0,0\n3,0,0,0\n", {.max_poses = 2});
  ASSERT_FALSE(trajectory);
  EXPECT_EQ(trajectory.error().code, ErrorCode::resources);
  EXPECT_THAT(trajectory.error().line(), HasSubstr("line 4: more than 2 poses"));
  EXPECT_EQ(read("time,x,y,z\n1,0,0,0\n", {.cancelled = [] { return true; }}).error().code, ErrorCode::interrupted);
}

}  // namespace
}  // namespace rayfield::formats
