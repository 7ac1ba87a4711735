#include "rayfield/core/text_file.h"

#include <fmt/core.h>

#include <cstddef>
#include <span>

#include "rayfield/core/file.h"

namespace rayfield {
namespace {

// toml++ parses, and frees, a key of n parts n calls deep, and knows no bound; 256 values in each other it does know.
constexpr std::size_t kMostKeyParts = 30;

/// Counts the parts of a key, character by character: dots outside of strings and comments, of which numbers have one.
class KeyParts {
 public:
  std::size_t next(char c) {
    if (c == '\n') {
      quote_ = '\0', comment_ = escaped_ = false, dots_ = 0;
    } else if (comment_ || escaped_) {
      escaped_ = false;
    } else if (quote_ != '\0') {
      escaped_ = c == '\\' && quote_ == '"';
      if (c == quote_) quote_ = '\0';
    } else if (c == '"' || c == '\'') {
      quote_ = c;
    } else if (c == '#') {
      comment_ = true;
    } else if (c == '.') {
      ++dots_;
    } else if (std::string_view(",=[]{}").find(c) != std::string_view::npos) {
      dots_ = 0;
    }
    return dots_ + 1;
  }

 private:
  char quote_ = '\0';
  bool comment_ = false, escaped_ = false;
  std::size_t dots_ = 0;
};

}  // namespace

Result<std::string> read_text_file(const std::string& path, std::string_view what) {
  const std::string_view next = "check the path";
  if (path.empty()) return fail(ErrorCode::usage, what, "", "the path is empty", "give the path of a file");
  RAYFIELD_ASSIGN(const InputDescriptor file, open_regular_file(path, what, next));
  if (file.size > kMaxTextFileBytes)
    return fail(ErrorCode::bad_input, what, path,
                fmt::format("larger than {} MiB, which no such file is", kMaxTextFileBytes >> 20), next);
  std::string text(static_cast<std::size_t>(file.size), '\0');
  RAYFIELD_ASSIGN(const std::size_t length,
                  read_at(file.descriptor, 0, std::as_writable_bytes(std::span(text)), what, path));
  text.resize(length);
  return text;
}

Result<void> check_toml_text(std::string_view text, std::string_view what, const std::string& name,
                             std::string_view next) {
  std::size_t line = 1;
  KeyParts parts;
  for (const char c : text) {
    if (parts.next(c) > kMostKeyParts)
      return fail(ErrorCode::usage, what, fmt::format("{}, line {}", name, line),
                  fmt::format("a key of more than {} parts", kMostKeyParts), next);
    const auto byte = static_cast<unsigned char>(c);
    if ((byte < 0x20 && c != '\t' && c != '\n' && c != '\r') || byte == 0x7f)
      return fail(ErrorCode::usage, what, fmt::format("{}, line {}", name, line),
                  "a control character, which TOML does not allow", next);
    if (c == '\n') ++line;
  }
  return {};
}

}  // namespace rayfield
