#include "formats/io/staged_output.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <random>

#include "rayfield/formats/exchange.h"
#include "rayfield/formats/geopackage.h"
#include "rayfield/formats/geotiff.h"
#include "rayfield/formats/picture.h"
#include "tests/formats/products_support.h"

// What all writers promise of the file system: whole files or none, and the right code when the disk says no.

namespace rayfield::formats {
namespace {

using testing::make_block;
using testing::read_file;
using testing::TemporaryFolder;

/// Incompressible, about 2.3 MB.
RasterProduct noise() {
  RasterProduct raster{"plan_density", "m2/m2", "", Grid2<float>({276000, 6099000}, 0.12, 800, 700)};
  std::mt19937 random(1);
  for (float& value : raster.grid.values) value = static_cast<float>(random()) * 1e-9F;
  return raster;
}

using Writer = std::function<Result<void>(const std::string&)>;

/// Every writer, with enough output to hit a limit of 64 KiB.
std::vector<std::pair<std::string, Writer>> writers() {
  const auto block = std::make_shared<BlockProducts>(make_block(6, 10, {"2018-12-12", "2019-02-11", "2019-03-20"}));
  const auto raster = std::make_shared<RasterProduct>(noise());
  return {{"a.tif", [raster](const std::string& path) { return write_cog(*raster, "EPSG:7854", path); }},
          {"a.gpkg", [block](const std::string& path) { return write_geopackage(*block, path); }},
          {"a.png", [raster](const std::string& path) { return write_plan_picture(*raster, {}, path); }},
          {"a.csv", [block](const std::string& path) { return write_row_metres_csv(*block, path); }}};
}

/// Runs `write` in a child process that may not write files larger than `bytes`; the exit status is the error code.
int code_with_file_limit(const Writer& write, const std::string& path, rlim_t bytes) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit = {bytes, bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const auto result = write(path);
    ::_exit(result ? 0 : static_cast<int>(result.error().code));
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Publish, ATooSmallDiskIsAResourceErrorAndTheOldFileStays) {
  for (const auto& [name, write] : writers()) {
    const TemporaryFolder folder;
    std::ofstream(folder / name) << "old";
    ASSERT_EQ(code_with_file_limit(write, folder / name, RLIM_INFINITY), 0) << name;
    ASSERT_GT(std::filesystem::file_size(folder / name), 20'000U) << name;
    std::ofstream(folder / name) << "old";
    EXPECT_EQ(code_with_file_limit(write, folder / name, 16384), static_cast<int>(ErrorCode::resources)) << name;
    EXPECT_EQ(read_file(folder / name), "old") << name;
    for (const std::string& left : folder.names()) EXPECT_EQ(left.find(".part-"), std::string::npos) << left;
  }
}

TEST(Publish, AFullFileSystemIsAResourceErrorAtAnySize) {
  for (const auto& [name, write] : writers()) {
    const TemporaryFolder reference, folder;
    ASSERT_TRUE(write(reference / name));
    // The raster needs 2.2 MB as working copy and as much again: some of the larger sizes fill up where GDAL flushes
    // its cache, writes the directories of the TIFF, or closes the file.
    for (const int kilobytes : {16, 64, 256, 1024, 2188, 2192, 2196, 2208, 2560, 3584, 4096, 4224, 4288, 4352, 4416,
                                4480, 4608, 5120, 6144}) {
      const std::string options = "size=" + std::to_string(kilobytes) + "k";
      if (::mount("rayfield", folder.path().c_str(), "tmpfs", 0, options.c_str()) != 0) {
        GTEST_SKIP() << "mounting a small file system needs more rights";
      }
      const auto result = write(folder / name);
      if (!result) {
        EXPECT_EQ(result.error().code, ErrorCode::resources) << result.error().line();
        EXPECT_TRUE(folder.names().empty()) << name;
      } else {
        EXPECT_TRUE(read_file(folder / name) == read_file(reference / name)) << name << " in " << options;
      }
      ASSERT_EQ(::umount(folder.path().c_str()), 0);
    }
  }
}

TEST(Publish, FoldersThatRefuseAreNamedWithTheRightCode) {
  const TemporaryFolder folder;
  for (const auto& [name, write] : writers()) {
    const auto missing = write(folder / ("no such folder/" + name));
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, ErrorCode::bad_input);
    EXPECT_NE(missing.error().line().find("no such folder/" + name), std::string::npos);
    const auto on_folder = write(folder.path());
    ASSERT_FALSE(on_folder);
    EXPECT_EQ(on_folder.error().code, ErrorCode::usage);
    if (std::filesystem::exists("/sys/kernel")) {
      const auto forbidden = write("/sys/kernel/" + name);
      ASSERT_FALSE(forbidden);
      EXPECT_EQ(forbidden.error().code, ErrorCode::resources) << forbidden.error().line();
    }
  }
}

TEST(Publish, NothingButTheProductIsLeftInTheFolder) {
  for (const auto& [name, write] : writers()) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write(folder / name));
    ASSERT_TRUE(write(folder / name)) << "over an existing file";
    std::vector<std::string> expected = {name};
    if (name == "a.tif") expected = {"a.qml", "a.tif"};
    EXPECT_EQ(folder.names(), expected);
    const auto mode = std::filesystem::status(folder / name).permissions();
    EXPECT_NE(mode & std::filesystem::perms::owner_write, std::filesystem::perms::none);
  }
}

TEST(Publish, FoldersOfKilledWritersAreRemovedAndThoseInUseAreNot) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / ".a.csv.part-dead01");
  std::ofstream(folder / ".a.csv.part-dead01/file") << "half";
  std::filesystem::create_directory(folder / ".a.csv.part-live01");
  std::filesystem::create_directory(folder / ".b.csv.part-other1");
  const int held = ::open((folder / ".a.csv.part-live01").c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(::flock(held, LOCK_EX | LOCK_NB), 0);
  ASSERT_TRUE(write_panels_csv(make_block(1, 2, {"2019-02-11"}), folder / "a.csv"));
  EXPECT_EQ(folder.names(), (std::vector<std::string>{".a.csv.part-live01", ".b.csv.part-other1", "a.csv"}));
  ::close(held);
}

TEST(Publish, APlainFileNameGoesToTheWorkingFolder) {
  const TemporaryFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const auto written = write_panels_csv(make_block(1, 2, {"2019-02-11"}), "plain.csv");
  std::filesystem::current_path(before);
  ASSERT_TRUE(written);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"plain.csv"});
}

}  // namespace
}  // namespace rayfield::formats
