#include "formats/io/staged_output.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>

namespace rayfield::formats {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view next_step = "check that the folder exists, is writable and has space";

std::string stage_prefix(const fs::path& target) {
  std::string prefix = target.filename().string();
  prefix.insert(prefix.begin(), '.');
  return prefix.append(".part-");
}

/// Removes folders of the same target that nobody holds any more (their writer was killed).
void remove_stale(const fs::path& parent, const std::string& prefix) {
  std::error_code error;
  std::vector<fs::path> stale;
  for (fs::directory_iterator it(parent, error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename().string().rfind(prefix, 0) == 0) stale.push_back(it->path());
  }
  for (const fs::path& folder : stale) {
    const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (fd < 0) continue;
    if (::flock(fd, LOCK_EX | LOCK_NB) == 0) fs::remove_all(folder, error);
    ::close(fd);
  }
}

/// Makes and locks a private folder; returns its descriptor, or -1 with errno. A cleaning writer may win the lock
/// between mkdtemp() and flock() and remove the folder (its link count is then 0): try again.
int make_locked_folder(const fs::path& parent, const std::string& prefix, std::string& folder) {
  for (int attempt = 0; attempt < 16; ++attempt) {
    std::string name = (parent / (prefix + "XXXXXX")).string();
    if (::mkdtemp(name.data()) == nullptr) return -1;
    const int fd = ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (fd < 0 && errno == ENOENT) continue;
    if (fd < 0) return -1;
    struct stat status = {};
    // File systems without flock() give no protection against a second writer's cleaning, which then fails as well.
    ::flock(fd, LOCK_EX);
    if (::fstat(fd, &status) == 0 && status.st_nlink > 0) {
      folder = name;
      return fd;
    }
    ::close(fd);
  }
  errno = EBUSY;
  return -1;
}

Result<void> sync_path(const std::string& path, int flags, std::string_view what) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC);
  if (fd < 0) return fail_errno(errno, what, path, next_step);
  const int sync_error = ::fsync(fd) == 0 ? 0 : errno;
  const int close_error = ::close(fd) == 0 ? 0 : errno;
  // Some file systems cannot sync a folder; the rename is then as durable as they make it.
  if (sync_error != 0 && !((flags & O_DIRECTORY) != 0 && sync_error == EINVAL)) {
    return fail_errno(sync_error, what, path, next_step);
  }
  if (close_error != 0) return fail_errno(close_error, what, path, next_step);
  return {};
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
  staged.lock_fd_ = make_locked_folder(parent, stage_prefix(path), staged.folder_);
  if (staged.lock_fd_ < 0) return fail_errno(errno, what, target, next_step);
  return staged;
}

StagedOutput::StagedOutput(StagedOutput&& other) noexcept
    : target_(std::move(other.target_)),
      what_(std::move(other.what_)),
      parent_(std::move(other.parent_)),
      folder_(std::exchange(other.folder_, {})),
      lock_fd_(std::exchange(other.lock_fd_, -1)) {}

StagedOutput::~StagedOutput() {
  if (!folder_.empty()) {
    std::error_code error;
    fs::remove_all(folder_, error);
  }
  if (lock_fd_ >= 0) ::close(lock_fd_);
}

std::string StagedOutput::path(std::string_view file_name) const { return folder_ + "/" + std::string(file_name); }

Result<void> StagedOutput::publish(std::string_view file_name, const std::string& destination) const {
  const std::string source = path(file_name);
  RAYFIELD_CHECK(sync_path(source, O_RDONLY, what_));
  if (::rename(source.c_str(), destination.c_str()) != 0) return fail_errno(errno, what_, destination, next_step);
  return sync_path(parent_, O_RDONLY | O_DIRECTORY, what_);
}

Result<void> write_bytes(const std::string& path, std::string_view bytes, std::string_view what) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (fd < 0) return fail_errno(errno, what, path, next_step);
  int error_number = 0;
  while (!bytes.empty() && error_number == 0) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (written < 0 && errno != EINTR) {
      error_number = errno;
    }
  }
  if (::close(fd) != 0 && error_number == 0) error_number = errno;
  if (error_number != 0) return fail_errno(error_number, what, path, next_step);
  return {};
}

Result<void> write_file_atomically(const std::string& target, std::string_view bytes, std::string_view what) {
  RAYFIELD_ASSIGN(const StagedOutput staged, StagedOutput::create(target, what));
  RAYFIELD_CHECK(write_bytes(staged.path("file"), bytes, what));
  return staged.publish("file");
}

}  // namespace rayfield::formats
