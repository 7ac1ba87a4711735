#include "rayfield/formats/product_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "rayfield/core/sha256.h"
#include "tests/formats/temporary_file.h"

namespace rayfield::formats {
namespace {

using ::testing::ElementsAre;
using testing::read_file;
using testing::TemporaryFolder;

void write(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

TEST(ProductFolder, ShowsNothingBeforeItIsPublishedAndThenEverything) {
  const TemporaryFolder folder;
  write(folder / "a.tif", "old");
  write(folder / "a.tif.aux.xml", "statistics of the old one");
  write(folder / "other", "not ours");
  {
    const auto products = ProductFolder::create(folder.path(), "list.json", "cannot export");
    ASSERT_TRUE(products) << products.error().line();
    write(products->path("a.tif"), "new");
    write(products->path("list.json"), "list");
    EXPECT_EQ(read_file(folder / "a.tif"), "old");
    EXPECT_FALSE(std::filesystem::exists(folder / "list.json"));
    const auto files = products->files();
    ASSERT_TRUE(files);
    ASSERT_EQ(files->size(), 2U);
    EXPECT_EQ((*files)[0].name, "a.tif");
    EXPECT_EQ((*files)[0].size, 3U);
    EXPECT_EQ((*files)[0].sha256, sha256_hex("new"));
    ASSERT_TRUE(products->publish());
  }
  EXPECT_EQ(read_file(folder / "a.tif"), "new");
  EXPECT_THAT(folder.names(), ElementsAre("a.tif", "list.json", "other"));
}

TEST(ProductFolder, LeavesTheFolderAsItWasWhenItIsDropped) {
  const TemporaryFolder folder;
  write(folder / "a.tif", "old");
  {
    const auto products = ProductFolder::create(folder.path(), "list.json", "cannot export");
    write(products->path("a.tif"), "new");
  }
  EXPECT_EQ(read_file(folder / "a.tif"), "old");
  EXPECT_THAT(folder.names(), ElementsAre("a.tif"));
}

TEST(ProductFolder, RemovesWhatAKilledWriterLeft) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / ".list.json.part-abcdef");
  write(folder / ".list.json.part-abcdef/a.tif", "half");
  ASSERT_TRUE(ProductFolder::create(folder.path(), "list.json", "cannot export"));
  EXPECT_TRUE(folder.names().empty());
}

TEST(ProductFolder, AFolderThatIsNotThereIsAnError) {
  const TemporaryFolder folder;
  const auto products = ProductFolder::create(folder / "absent", "list.json", "cannot export");
  ASSERT_FALSE(products);
  EXPECT_EQ(products.error().code, ErrorCode::bad_input);
}

}  // namespace
}  // namespace rayfield::formats
