#include "cli/simulation/staged_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>
#include <vector>

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;
constexpr const char* kWhat = "cannot make folder";

Result<void> move_files(const fs::path& from, const fs::path& to) {
  std::error_code failed;
  std::vector<fs::path> files;
  for (fs::recursive_directory_iterator it(from, failed), end; !failed && it != end; it.increment(failed)) {
    if (it->is_regular_file(failed)) files.push_back(it->path().lexically_relative(from));
    if (failed) break;  // before increment() forgets it
  }
  for (const fs::path& file : files) {
    if (!failed) fs::create_directories((to / file).parent_path(), failed);
    if (!failed) fs::rename(from / file, to / file, failed);
  }
  if (failed) return fail_output(failed.value(), kWhat, to.string());
  return {};
}

}  // namespace

Result<StagedFolder> StagedFolder::create(const fs::path& target) {
  const fs::path path = target.parent_path() / ("." + target.filename().string() + ".part");
  std::error_code failed;
  RAYFIELD_ASSIGN(OutputFolder parent, OutputFolder::make(path.parent_path().empty() ? "." : path.parent_path()));
  const auto open_it = [&] {
    return FileDescriptor(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  };
  if (const FileDescriptor left = open_it(); left.valid()) {
    if (::flock(left.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
      return fail(ErrorCode::usage, kWhat, target.string(), "another rayfield is writing it",
                  "wait until it has finished");
    fs::remove_all(path, failed);
  }
  if (::mkdir(path.c_str(), 0777) != 0) return fail_output(errno, kWhat, path.string());
  FileDescriptor lock = open_it();
  if (!lock.valid()) return fail_output(errno, kWhat, path.string());
  ::flock(lock.get(), LOCK_EX);
  return StagedFolder(target, path, std::move(parent), std::move(lock));
}

StagedFolder::StagedFolder(StagedFolder&& other) noexcept
    : target_(std::move(other.target_)),
      path_(std::exchange(other.path_, {})),
      parent_(std::move(other.parent_)),
      lock_(std::move(other.lock_)) {}

StagedFolder::~StagedFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

Result<void> StagedFolder::publish() {
  std::error_code failed;
  if (fs::exists(target_, failed)) {
    RAYFIELD_CHECK(move_files(path_, target_));
  } else {
    fs::rename(path_, target_, failed);
    if (failed) return fail_output(failed.value(), kWhat, target_.string());
    path_.clear();
  }
  return sync_directory(target_.parent_path().string(), kWhat);
}

}  // namespace rayfield::cli
