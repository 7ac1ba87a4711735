#include <stdlib.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "rayfield/formats/reference_file.h"

namespace {

namespace fs = std::filesystem;

/// Files in a folder of its own, since readers choose by the ending.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "rayfield-fuzz-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  std::string write(const char* name, const std::uint8_t* data, std::size_t size) const {
    const fs::path path = path_ / name;
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    if (!out.flush()) std::abort();
    return path.string();
  }

 private:
  fs::path path_;
};

}  // namespace

/// Whatever the bytes of a reference layer; the first one chooses its kind. An error with its reason, or rows and posts
/// at finite places.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder kFolder;
  if (size == 0) return 0;
  static constexpr const char* kNames[] = {"reference.geojson", "reference.csv", "reference.gpkg"};
  const std::string path = kFolder.write(kNames[data[0] % 3], data + 1, size - 1);
  const auto block = rayfield::formats::read_reference_file(path, "EPSG:7854");
  if (!block) {
    if (block.error().why.empty()) std::abort();
    return 0;
  }
  for (const auto& row : block->rows) {
    for (const auto& p : row.line) {
      if (!p.allFinite()) std::abort();
    }
  }
  for (const auto& post : block->posts) {
    if (!post.position.allFinite()) std::abort();
  }
  return 0;
}
