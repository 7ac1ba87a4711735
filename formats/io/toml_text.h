#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace rayfield::formats {

/// A TOML basic string with its quotes; whatever a log names a topic, it stays one string.
inline std::string toml_quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      out += c;
    }
  }
  out += '"';
  return out;
}

}  // namespace rayfield::formats
