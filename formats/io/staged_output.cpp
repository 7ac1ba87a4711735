#include "formats/io/staged_output.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <utility>

namespace rayfield::formats {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kNext = "check that the folder exists, is writable and has space";

std::string stage_prefix(const fs::path& target) {
  std::string prefix = target.filename().string();
  prefix.insert(prefix.begin(), '.');
  return prefix.append(".part-");
}

FileDescriptor open_folder(const std::string& path) {
  return FileDescriptor(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
}

/// Removes folders of the same target that nobody holds any more (their writer was killed).
void remove_stale(const fs::path& parent, const std::string& prefix) {
  std::error_code error;
  std::vector<fs::path> stale;
  for (fs::directory_iterator it(parent, error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename().string().rfind(prefix, 0) == 0) stale.push_back(it->path());
  }
  for (const fs::path& folder : stale) {
    const FileDescriptor file = open_folder(folder.string());
    if (file.valid() && ::flock(file.get(), LOCK_EX | LOCK_NB) == 0) fs::remove_all(folder, error);
  }
}

struct LockedFolder {
  std::string path;
  FileDescriptor lock;
};

/// Makes and locks a private folder. A cleaning writer may win the lock between mkdtemp() and flock() and remove the
/// folder (its link count is then 0): try again.
Result<LockedFolder> make_locked_folder(const fs::path& target, const fs::path& parent, std::string_view what) {
  for (int attempt = 0; attempt < 16; ++attempt) {
    std::string name = (parent / (stage_prefix(target) + "XXXXXX")).string();
    if (::mkdtemp(name.data()) == nullptr) return fail_errno(errno, what, target.string(), kNext);
    FileDescriptor lock = open_folder(name);
    if (!lock.valid() && errno == ENOENT) continue;
    if (!lock.valid()) return fail_errno(errno, what, target.string(), kNext);
    struct stat status = {};
    // File systems without flock() give no protection against a second writer's cleaning, which then fails as well.
    ::flock(lock.get(), LOCK_EX);
    if (::fstat(lock.get(), &status) == 0 && status.st_nlink > 0) return LockedFolder{name, std::move(lock)};
  }
  return fail_errno(EBUSY, what, target.string(), kNext);
}

}  // namespace

Result<StagedOutput> StagedOutput::create(const std::string& target, std::string_view what) {
  const fs::path path(target);
  if (path.filename().empty() || path.filename() == "." || path.filename() == "..") {
    return fail(ErrorCode::usage, what, target, "not a file name", "give a path that ends in a file name");
  }
  std::error_code error;
  if (fs::is_directory(path, error)) {
    return fail(ErrorCode::usage, what, target, "is a folder", "give a path that ends in a file name");
  }
  StagedOutput staged;
  staged.target_ = target;
  staged.what_ = what;
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  staged.parent_ = parent.string();
  remove_stale(parent, stage_prefix(path));
  RAYFIELD_ASSIGN(LockedFolder folder, make_locked_folder(path, parent, what));
  staged.folder_ = std::move(folder.path);
  staged.lock_ = std::move(folder.lock);
  return staged;
}

StagedOutput::StagedOutput(StagedOutput&& other) noexcept
    : target_(std::move(other.target_)),
      what_(std::move(other.what_)),
      parent_(std::move(other.parent_)),
      folder_(std::exchange(other.folder_, {})),
      lock_(std::move(other.lock_)) {}

StagedOutput::~StagedOutput() {
  if (folder_.empty()) return;
  std::error_code error;
  fs::remove_all(folder_, error);
  if (error) fs::remove_all(folder_, error);  // a fault that passes; what stays is removed by the next output
}

std::string StagedOutput::path(std::string_view file_name) const { return folder_ + "/" + std::string(file_name); }

Result<void> StagedOutput::publish(std::string_view file_name, const std::string& destination) const {
  const std::string source = path(file_name);
  RAYFIELD_ASSIGN(const InputDescriptor file, open_regular_file(source, what_, kNext));
  RAYFIELD_CHECK(sync_file(file.descriptor, what_, source, kNext));
  if (::rename(source.c_str(), destination.c_str()) != 0) return fail_errno(errno, what_, destination, kNext);
  return sync_directory(parent_, what_, kNext);
}

Result<void> write_file_atomically(const std::string& target, std::string_view bytes, std::string_view what) {
  RAYFIELD_ASSIGN(const StagedOutput staged, StagedOutput::create(target, what));
  RAYFIELD_CHECK(write_whole_file(staged.path("file"), std::as_bytes(std::span(bytes)), what, kNext));
  return staged.publish("file");
}

}  // namespace rayfield::formats
