#include "formats/io/file_io.h"

#include <fcntl.h>
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

}  // namespace

Result<InputFile> InputFile::open(const std::string& path, const std::string& what) {
  InputFile file;
  RAYFIELD_ASSIGN(file.file_, open_regular_file(path, what, "check the path and its permissions"));
  file.path_ = path;
  file.what_ = what;
  return file;
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

OutputFile::~OutputFile() {
  if (descriptor_.valid()) ::unlink(temporary_.c_str());
}

Result<OutputFile> OutputFile::create(const std::string& path, const std::string& what) {
  OutputFile file;
  file.path_ = path;
  file.what_ = what;
  std::random_device entropy;
  for (int attempt = 0; attempt < 16; ++attempt) {
    file.temporary_ = path + ".partial-" + std::to_string(entropy());
    file.descriptor_ = FileDescriptor(::open(file.temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (file.descriptor_.valid()) break;
    if (errno == ENOENT || errno == ENOTDIR) {
      return fail(ErrorCode::usage, what, path, "there is no such folder", "make it, or give another path");
    }
    if (errno != EEXIST) return fail_errno(errno, what, path, "check that the folder can be written to");
  }
  if (!file.descriptor_.valid()) return fail_errno(EEXIST, what, path);
  file.buffer_.reserve(kWriteBuffer);
  return file;
}

Result<void> OutputFile::write_through(std::uint64_t offset, std::span<const std::byte> bytes) {
  return write_at(descriptor_, offset, bytes, what_, path_, "free some space or choose another folder");
}

Result<void> OutputFile::flush() {
  RAYFIELD_CHECK(write_through(flushed_, buffer_));
  flushed_ += buffer_.size();
  buffer_.clear();
  return {};
}

Result<void> OutputFile::write(std::span<const std::byte> bytes) {
  if (!descriptor_.valid()) return fail(ErrorCode::internal, what_, path_, "the file was already finished");
  if (buffer_.size() + bytes.size() > kWriteBuffer) RAYFIELD_CHECK(flush());
  if (bytes.size() >= kWriteBuffer) {
    RAYFIELD_CHECK(write_through(flushed_, bytes));
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
  if (!descriptor_.valid()) return fail(ErrorCode::internal, what_, path_, "the file was already finished");
  RAYFIELD_CHECK(flush());
  if (offset + bytes.size() > flushed_) return fail(ErrorCode::internal, what_, path_, "overwriting past the end");
  return write_through(offset, bytes);
}

Result<void> OutputFile::commit() {
  if (!descriptor_.valid()) return fail(ErrorCode::internal, what_, path_, "the file was already finished");
  RAYFIELD_CHECK(flush());
  RAYFIELD_CHECK(sync_file(descriptor_, what_, path_));
  int error_number = descriptor_.close();
  if (error_number == 0 && ::rename(temporary_.c_str(), path_.c_str()) != 0) error_number = errno;
  if (error_number != 0) {
    ::unlink(temporary_.c_str());
    return fail_errno(error_number, what_, path_);
  }
  // A renamed file survives a power cut only once its folder has been synced too.
  return sync_directory(std::filesystem::path(path_).parent_path().string(), what_);
}

}  // namespace rayfield::formats
