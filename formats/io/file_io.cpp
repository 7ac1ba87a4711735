#include "formats/io/file_io.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <random>
#include <utility>

namespace rayfield::formats {
namespace {

constexpr std::size_t kWriteBuffer = std::size_t{1} << 20;

Result<void> write_fully(int descriptor, std::uint64_t offset, std::span<const std::byte> bytes,
                         const std::string& what, const std::string& where) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0) {
      if (errno == EINTR) continue;
      return fail_errno(errno, what, where, "free some space or choose another folder");
    }
    if (written == 0) return fail_errno(ENOSPC, what, where, "free some space or choose another folder");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
  return {};
}

/// A renamed file survives a power cut only once its folder has been synced too.
Result<void> sync_folder(const std::string& path, const std::string& what) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return fail_errno(errno, what, path);
  const int synced = ::fsync(descriptor);
  const int error_number = errno;
  ::close(descriptor);
  // Some file systems cannot sync folders and say EINVAL; there is nothing more to do there.
  if (synced != 0 && error_number != EINVAL) return fail_errno(error_number, what, path);
  return {};
}

}  // namespace

InputFile::InputFile(InputFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_),
      path_(std::move(other.path_)),
      what_(std::move(other.what_)) {}

InputFile& InputFile::operator=(InputFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(size_, other.size_);
  path_.swap(other.path_);
  what_.swap(other.what_);
  return *this;
}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<InputFile> InputFile::open(const std::string& path, const std::string& what) {
  InputFile file;
  file.path_ = path;
  file.what_ = what;
  // Without O_NONBLOCK, opening a pipe would wait for its writer before it could be refused.
  file.descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file.descriptor_ < 0) return fail_errno(errno, what, path, "check the path and its permissions");
  struct stat status = {};
  if (::fstat(file.descriptor_, &status) != 0) return fail_errno(errno, what, path);
  if (!S_ISREG(status.st_mode)) {
    return fail(ErrorCode::bad_input, what, path, "not a regular file", "give the path of a file");
  }
  file.size_ = static_cast<std::uint64_t>(status.st_size);
  return file;
}

Result<std::size_t> InputFile::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got =
        ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (got < 0) {
      if (errno == EINTR) continue;
      return fail_errno(errno, what_, path_ + " at byte " + std::to_string(offset + done));
    }
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

FileWindow::FileWindow(InputFile file, std::size_t window_bytes) : file_(std::move(file)) {
  buffer_.resize(
      static_cast<std::size_t>(std::clamp<std::uint64_t>(file_.size(), 1, static_cast<std::uint64_t>(window_bytes))));
}

Result<std::span<const std::byte>> FileWindow::view(std::uint64_t offset, std::size_t count) {
  if (offset >= file_.size()) return std::span<const std::byte>();
  count = static_cast<std::size_t>(std::min<std::uint64_t>(count, file_.size() - offset));
  if (offset < start_ || offset + count > start_ + filled_) {
    std::size_t kept = 0;
    if (offset >= start_ && offset < start_ + filled_) {
      kept = static_cast<std::size_t>(start_ + filled_ - offset);
      std::memmove(buffer_.data(), buffer_.data() + (offset - start_), kept);
    }
    if (count > buffer_.size()) buffer_.resize(count);
    start_ = offset;
    filled_ = kept;
    RAYFIELD_ASSIGN(const std::size_t got, file_.read_at(offset + kept, std::span(buffer_).subspan(kept)));
    filled_ += got;
  }
  const std::size_t at = static_cast<std::size_t>(offset - start_);
  return std::span<const std::byte>(buffer_).subspan(at, std::min(count, filled_ - at));
}

OutputFile::OutputFile(OutputFile&& other) noexcept { *this = std::move(other); }

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(flushed_, other.flushed_);
  buffer_.swap(other.buffer_);
  path_.swap(other.path_);
  temporary_.swap(other.temporary_);
  what_.swap(other.what_);
  return *this;
}

OutputFile::~OutputFile() { discard(); }

void OutputFile::discard() {
  if (descriptor_ < 0) return;
  ::close(std::exchange(descriptor_, -1));
  ::unlink(temporary_.c_str());
}

Result<OutputFile> OutputFile::create(const std::string& path, const std::string& what) {
  OutputFile file;
  file.path_ = path;
  file.what_ = what;
  std::random_device entropy;
  for (int attempt = 0; attempt < 16; ++attempt) {
    file.temporary_ = path + ".partial-" + std::to_string(entropy());
    file.descriptor_ = ::open(file.temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file.descriptor_ >= 0) break;
    if (errno == ENOENT || errno == ENOTDIR) {
      return fail(ErrorCode::usage, what, path, "there is no such folder", "make it, or give another path");
    }
    if (errno != EEXIST) return fail_errno(errno, what, path, "check that the folder can be written to");
  }
  if (file.descriptor_ < 0) return fail_errno(EEXIST, what, path);
  file.buffer_.reserve(kWriteBuffer);
  return file;
}

Result<void> OutputFile::flush() {
  RAYFIELD_CHECK(write_fully(descriptor_, flushed_, buffer_, what_, path_));
  flushed_ += buffer_.size();
  buffer_.clear();
  return {};
}

Result<void> OutputFile::write(std::span<const std::byte> bytes) {
  if (descriptor_ < 0) return fail(ErrorCode::internal, what_, path_, "the file was already finished");
  if (buffer_.size() + bytes.size() > kWriteBuffer) RAYFIELD_CHECK(flush());
  if (bytes.size() >= kWriteBuffer) {
    RAYFIELD_CHECK(write_fully(descriptor_, flushed_, bytes, what_, path_));
    flushed_ += bytes.size();
    return {};
  }
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  return {};
}

Result<void> OutputFile::write(std::string_view text) {
  return write(std::as_bytes(std::span<const char>(text.data(), text.size())));
}

Result<void> OutputFile::overwrite(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (descriptor_ < 0) return fail(ErrorCode::internal, what_, path_, "the file was already finished");
  RAYFIELD_CHECK(flush());
  if (offset + bytes.size() > flushed_) return fail(ErrorCode::internal, what_, path_, "overwriting past the end");
  return write_fully(descriptor_, offset, bytes, what_, path_);
}

Result<void> OutputFile::commit() {
  if (descriptor_ < 0) return fail(ErrorCode::internal, what_, path_, "the file was already finished");
  RAYFIELD_CHECK(flush());
  if (::fsync(descriptor_) != 0) return fail_errno(errno, what_, path_);
  const int closed = ::close(std::exchange(descriptor_, -1));
  const int close_error = errno;
  if (closed != 0 || ::rename(temporary_.c_str(), path_.c_str()) != 0) {
    const int error_number = closed != 0 ? close_error : errno;
    ::unlink(temporary_.c_str());
    return fail_errno(error_number, what_, path_);
  }
  return sync_folder(path_, what_);
}

}  // namespace rayfield::formats
