#include "cli/console/output_paths.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "rayfield/core/nameless_file.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

// Permissions, read-only mounts and full inode tables all show when a file is made.
Result<void> check_folder(const OutputPath& output) {
  const fs::path parent = fs::path(output.path).parent_path();
  const fs::path folder = parent.empty() ? fs::path(".") : parent;
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    return fail(ErrorCode::usage, output.what, output.path, fmt::format("there is no folder {}", folder.string()),
                "make it, or give another " + output.option);
  const FileDescriptor file = make_nameless_file(folder);
  const int error = errno;
  if (!file.valid() && (error == ENOENT || error == ENOTDIR))  // a file system that takes no files, like /proc
    return fail(ErrorCode::resources, output.what, output.path,
                fmt::format("no file can be made in {}", folder.string()), "give another " + output.option);
  if (!file.valid())
    return fail_output(
        error, output.what, output.path,
        fmt::format("check that {} can be written to, or give another {}", folder.string(), output.option));
  return {};
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code failed;
  if (fs::equivalent(a, b, failed) && !failed) return true;
  return fs::absolute(a).lexically_normal() == fs::absolute(b).lexically_normal();
}

// A folder that every command would take for a store.
bool is_store(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / "store.json", ignored) && fs::exists(folder / "snapshots", ignored);
}

// Writers of products look for folders of that name whose owner was killed, and leave locked ones alone.
Result<std::pair<std::string, FileDescriptor>> hold_folder(const OutputPath& output) {
  const fs::path target(output.path);
  const std::string path = (target.parent_path() / ("." + target.filename().string() + ".part-lock")).string();
  constexpr int kAttempts = 16;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (::mkdir(path.c_str(), 0700) != 0 && errno != EEXIST) return fail_output(errno, output.what, output.path);
    FileDescriptor folder(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    if (!folder.valid() && errno == ENOENT) continue;
    if (!folder.valid()) return fail_output(errno, output.what, path);
    // File systems without flock() give no protection.
    if (::flock(folder.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) break;
    struct stat status {};
    // Removed between open() and flock() by a program that has just ended: once more.
    if (::fstat(folder.get(), &status) == 0 && status.st_nlink > 0) return std::pair(path, std::move(folder));
  }
  return fail(ErrorCode::usage, output.what, output.path, "another rayfield is writing it",
              "wait until it has finished, or give another " + output.option);
}

}  // namespace

// Links on the way are followed: the place counts, not how it is written.
Result<void> check_outside_stores(const fs::path& output, std::string_view what, std::string_view next) {
  std::error_code failed;
  const fs::path place = fs::weakly_canonical(fs::absolute(output, failed), failed);
  if (failed) return {};  // such a place is refused where it is written to
  for (fs::path folder = place;; folder = folder.parent_path()) {
    if (is_store(folder))
      return fail(ErrorCode::usage, what, output.string(),
                  fmt::format("it lies in the store {}, where nothing but its own files belongs", folder.string()),
                  next);
    if (folder == folder.parent_path()) return {};
  }
}

Result<void> check_outputs(std::span<const OutputPath> outputs, std::span<const std::string> inputs, bool overwrite) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const OutputPath& output = outputs[i];
    const auto refuse = [&](std::string_view why, std::string_view next) {
      return fail(ErrorCode::usage, output.what, output.path, why, next);
    };
    const std::string another = "give another " + output.option;
    std::error_code ignored;
    if (fs::path(output.path).filename().empty()) return refuse("the path does not name a file", another);
    RAYFIELD_CHECK(check_outside_stores(output.path, output.what, another));
    const fs::file_status status = fs::status(output.path, ignored);
    if (fs::is_directory(status)) return refuse("it is a folder", another);
    // A device or pipe would be replaced by a file.
    if (fs::exists(status) && !fs::is_regular_file(status)) return refuse("it is not a regular file", another);
    for (const std::string& input : inputs)
      if (!input.empty() && same_file(output.path, input)) return refuse("it is an input of this command", another);
    for (std::size_t k = 0; k < i; ++k)
      if (same_file(output.path, outputs[k].path))
        return refuse(fmt::format("{} names the same file", outputs[k].option), another);
    if (fs::exists(fs::symlink_status(output.path, ignored)) && !overwrite)
      return refuse("it is there already", another + ", or --overwrite");
    RAYFIELD_CHECK(check_folder(output));
  }
  return {};
}

Result<OutputFolder> OutputFolder::make(const fs::path& folder) {
  constexpr std::string_view kWhat = "cannot make folder", kNext = "give another -o";
  RAYFIELD_CHECK(check_outside_stores(folder, kWhat, kNext));
  OutputFolder output;
  std::error_code failed;
  for (fs::path path = fs::absolute(folder, failed).lexically_normal(); !failed && !fs::exists(path, failed) && !failed;
       path = path.parent_path())
    if (path.has_filename()) output.made_.push_back(path);
  if (!failed) fs::create_directories(folder, failed);
  if (failed) return fail_output(failed.value(), kWhat, folder.string(), kNext);
  for (const fs::path& path : output.made_) RAYFIELD_CHECK(sync_directory(path.parent_path().string(), kWhat, kNext));
  return output;
}

OutputFolder::~OutputFolder() {
  for (const fs::path& path : made_) ::rmdir(path.c_str());
}

Result<NewOutputs> NewOutputs::hold(std::span<const OutputPath> outputs) {
  NewOutputs all;
  for (const OutputPath& output : outputs) {
    RAYFIELD_ASSIGN(auto held, hold_folder(output));
    all.held_.push_back(std::move(held));
  }
  std::error_code ignored;
  for (const OutputPath& output : outputs)
    if (!fs::exists(fs::symlink_status(output.path, ignored))) all.new_.push_back(output.path);
  return all;
}

NewOutputs::~NewOutputs() {
  for (const std::string& path : new_) ::unlink(path.c_str());
  for (const auto& [path, folder] : held_) ::rmdir(path.c_str());
}

}  // namespace rayfield::cli
