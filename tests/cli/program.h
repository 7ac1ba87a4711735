#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace rayfield::test {

/// What a run of the command line gave.
struct Outcome {
  int exit_code = -1;  ///< 128 + signal when it was killed
  std::string out, err;
  std::uint64_t peak_bytes = 0;  ///< resident memory at most
  /// Number of lines on stderr that begin with "rayfield: ", the form of an error.
  int error_lines() const;
};

/// Runs the program under test without a shell; `environment` is added to ours.
Outcome rayfield(const std::vector<std::string>& arguments, const std::map<std::string, std::string>& environment = {});

/// The same with a limit on the size of any file that it writes: what a full disk looks like.
Outcome rayfield_with_file_limit(const std::vector<std::string>& arguments, std::uint64_t bytes);

/// The same with its stdout going to `path`, such as /dev/full.
Outcome rayfield_printing_to(const std::string& path, const std::vector<std::string>& arguments);

/// The same, with a Ctrl-C as soon as its stderr holds `text`.
Outcome rayfield_interrupted_at(const std::vector<std::string>& arguments, const std::string& text);

/// The same, with a Ctrl-C after so many milliseconds.
Outcome rayfield_interrupted_after(const std::vector<std::string>& arguments, unsigned milliseconds);

/// A fresh folder that is removed at the end.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string path(const std::string& name = {}) const;

 private:
  std::filesystem::path root_;
};

std::string read_file(const std::filesystem::path& path);
void write_file(const std::filesystem::path& path, const std::string& content);

/// SHA-256 of every file below a folder, by relative path. Snapshots, the store's lock and its own description are
/// left out: they hold times and command lines.
std::map<std::string, std::string> content_of(const std::filesystem::path& folder);

/// Dates of a site: with 40 % of its leaves, and with all.
inline const std::string kEarlyDate = "[[date]]\ndate = \"2021-05-01\"\nleaf_fraction = 0.4\nseed = 1\n";
inline const std::string kLateDate = "[[date]]\ndate = \"2021-07-01\"\nleaf_fraction = 1.0\nseed = 2\n";

/// A small block of two short rows, seconds to simulate; written as site.toml into the folder. Returns its path.
std::string small_site(const Folder& folder, const std::string& dates = kEarlyDate + kLateDate);

}  // namespace rayfield::test
