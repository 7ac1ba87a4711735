#include "rayfield/core/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <vector>

#include "rayfield/core/sha256.h"

namespace rayfield {

FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
  if (this != &other) {
    close();
    descriptor_ = other.release();
  }
  return *this;
}

int FileDescriptor::close() {
  if (descriptor_ < 0) return 0;
  // Linux frees the descriptor even when close() fails, EINTR included: it must not be repeated.
  return ::close(release()) == 0 || errno == EINTR ? 0 : errno;
}

Result<InputDescriptor> open_regular_file(const std::string& path, std::string_view what, std::string_view next) {
  // Without O_NONBLOCK, opening a pipe would wait for its writer before it could be refused.
  InputDescriptor file{FileDescriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)), 0};
  struct stat status = {};
  if (!file.descriptor.valid() || ::fstat(file.descriptor.get(), &status) != 0)
    return fail_errno(errno, what, path, next);
  if (!S_ISREG(status.st_mode))
    return fail(ErrorCode::bad_input, what, path, "not a regular file", "give the path of a file");
  file.size = static_cast<std::uint64_t>(status.st_size);
  return file;
}

Result<std::size_t> read_at(const FileDescriptor& file, std::uint64_t offset, std::span<std::byte> bytes,
                            std::string_view what, const std::string& path) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got =
        ::pread(file.get(), bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail_errno(errno, what, path + " at byte " + std::to_string(offset + done));
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

Result<void> write_at(const FileDescriptor& file, std::uint64_t offset, std::span<const std::byte> bytes,
                      std::string_view what, const std::string& path, std::string_view next) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file.get(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return fail_errno(written < 0 ? errno : ENOSPC, what, path, next);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
  return {};
}

Result<void> write_whole_file(const std::string& path, std::span<const std::byte> bytes, std::string_view what,
                              std::string_view next) {
  FileDescriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (!file.valid()) return fail_errno(errno, what, path, next);
  RAYFIELD_CHECK(write_at(file, 0, bytes, what, path, next));
  if (const int error = file.close()) return fail_errno(error, what, path, next);
  return {};
}

Result<FileDigest> digest_file(const std::string& path, std::string_view what, const std::function<bool()>& cancelled) {
  RAYFIELD_ASSIGN(const InputDescriptor file, open_regular_file(path, what, "check the path"));
  Sha256 hash;
  FileDigest digest;
  std::vector<std::byte> piece(std::size_t{1} << 20);
  while (true) {
    if (cancelled && cancelled()) return fail(ErrorCode::interrupted, "interrupted", path, "", "run it again");
    RAYFIELD_ASSIGN(const std::size_t got, read_at(file.descriptor, digest.size, piece, what, path));
    hash.update(std::span<const std::byte>(piece).first(got));
    digest.size += got;
    if (got < piece.size()) break;
  }
  digest.sha256 = hash.hex();
  return digest;
}

Result<void> sync_file(const FileDescriptor& file, std::string_view what, const std::string& path,
                       std::string_view next) {
  if (::fsync(file.get()) != 0) return fail_errno(errno, what, path, next);
  return {};
}

Result<void> sync_directory(const std::string& folder, std::string_view what, std::string_view next) {
  const std::string path = folder.empty() ? "." : folder;
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!file.valid()) return fail_errno(errno, what, path, next);
  if (::fsync(file.get()) != 0 && errno != EINVAL) return fail_errno(errno, what, path, next);
  return {};
}

}  // namespace rayfield
