#include "rayfield/core/text_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>

namespace rayfield {
namespace {

class Descriptor {
 public:
  // Without O_NONBLOCK, opening a pipe would wait for its writer before it could be refused.
  explicit Descriptor(const std::string& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

}  // namespace

Result<std::string> read_text_file(const std::string& path, std::string_view what) {
  const std::string_view next = "check the path";
  if (path.empty()) return fail(ErrorCode::usage, what, "", "the path is empty", "give the path of a file");
  const Descriptor file(path);
  struct stat status = {};
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0) return fail_errno(errno, what, path, next);
  if (!S_ISREG(status.st_mode))
    return fail(ErrorCode::bad_input, what, path, "not a regular file", "give the path of a file");
  if (static_cast<std::uint64_t>(status.st_size) > kMaxTextFileBytes)
    return fail(ErrorCode::bad_input, what, path,
                fmt::format("larger than {} MiB, which no such file is", kMaxTextFileBytes >> 20), next);
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t got = ::read(file.get(), text.data() + done, text.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail_errno(errno, what, path, next);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  text.resize(done);
  return text;
}

Result<void> check_toml_text(std::string_view text, std::string_view what, const std::string& name,
                             std::string_view next) {
  std::size_t line = 1;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte < 0x20 && c != '\t' && c != '\n' && c != '\r') || byte == 0x7f)
      return fail(ErrorCode::usage, what, fmt::format("{}, line {}", name, line),
                  "a control character, which TOML does not allow", next);
    if (c == '\n') ++line;
  }
  return {};
}

}  // namespace rayfield
