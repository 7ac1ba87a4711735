#include "rayfield/core/text_file.h"

#include <fmt/core.h>

#include <cstdint>
#include <span>

#include "rayfield/core/file.h"

namespace rayfield {
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
