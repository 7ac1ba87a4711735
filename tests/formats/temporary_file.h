#pragma once

#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

/// Files and folders that tests make, and those that are shared between projects.
namespace rayfield::formats::testing {

/// A file that is gone when the test is over.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& content, const std::string& suffix = ".bag") {
    static int number = 0;
    // In memory where the system has such a folder: these tests write thousands of files.
    const std::filesystem::path shared_memory = "/dev/shm";
    const bool in_memory = ::access(shared_memory.c_str(), W_OK) == 0;
    path_ = ((in_memory ? shared_memory : std::filesystem::temp_directory_path()) /
             ("rayfield_formats_" + std::to_string(::getpid()) + "_" + std::to_string(number++) + suffix))
                .string();
    write(content);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  void write(const std::string& content) const {
    std::ofstream(path_, std::ios::binary | std::ios::trunc)
        .write(content.data(), static_cast<std::streamsize>(content.size()));
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

inline std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// The folder of shared test data; empty where it is absent.
inline std::string shared_folder() {
  const char* from_environment = std::getenv("RAYFIELD_SHARED");
  const std::string folder = from_environment != nullptr ? from_environment : RAYFIELD_SHARED_DEFAULT;
  return std::filesystem::is_directory(folder + "/data") ? folder + "/data" : std::string();
}

/// A folder that goes with the test.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "rayfield-gis-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string operator/(const std::string& name) const { return (folder_ / name).string(); }
  std::string path() const { return folder_.string(); }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) all.push_back(entry.path().filename());
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace rayfield::formats::testing
