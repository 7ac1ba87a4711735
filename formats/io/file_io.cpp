#include "formats/io/file_io.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "formats/io/staged_output.h"

namespace rayfield::formats {
namespace {

constexpr std::size_t kWriteBuffer = std::size_t{1} << 20;
constexpr std::string_view kStagedName = "file";

}  // namespace

Result<InputFile> InputFile::open(const std::string& path, const std::string& what) {
  InputFile file;
  RAYFIELD_ASSIGN(file.file_, open_regular_file(path, what, "check the path and its permissions"));
  file.path_ = path;
  file.what_ = what;
  return file;
}

FileWindow::FileWindow(InputFile file, std::size_t window_bytes) : file_(std::move(file)), window_bytes_(window_bytes) {
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
    // With a window more than was asked for, as the next request of that size is likely to begin a little further on.
    if (count > buffer_.size()) buffer_.resize(count + window_bytes_);
    start_ = offset;
    filled_ = kept;
    RAYFIELD_ASSIGN(const std::size_t got, file_.read_at(offset + kept, std::span(buffer_).subspan(kept)));
    filled_ += got;
  }
  const std::size_t at = static_cast<std::size_t>(offset - start_);
  return std::span<const std::byte>(buffer_).subspan(at, std::min(count, filled_ - at));
}

OutputFile::OutputFile() = default;
OutputFile::OutputFile(OutputFile&& other) noexcept { *this = std::move(other); }

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(flushed_, other.flushed_);
  buffer_.swap(other.buffer_);
  path_.swap(other.path_);
  staged_.swap(other.staged_);
  what_.swap(other.what_);
  return *this;
}

OutputFile::~OutputFile() = default;

Result<OutputFile> OutputFile::create(const std::string& path, const std::string& what) {
  OutputFile file;
  file.path_ = path;
  file.what_ = what;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code ignored;
  if (!folder.empty() && !std::filesystem::is_directory(folder, ignored))
    return fail(ErrorCode::usage, what, path, "there is no such folder", "make it, or give another path");
  RAYFIELD_ASSIGN(StagedOutput staged, StagedOutput::create(path, what));
  file.descriptor_ =
      FileDescriptor(::open(staged.path(kStagedName).c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file.descriptor_.valid()) return fail_errno(errno, what, path, "check that the folder can be written to");
  file.staged_ = std::make_unique<StagedOutput>(std::move(staged));
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
  if (const int error = descriptor_.close()) return fail_errno(error, what_, path_);
  RAYFIELD_CHECK(staged_->publish(kStagedName));
  staged_.reset();
  return {};
}

}  // namespace rayfield::formats
