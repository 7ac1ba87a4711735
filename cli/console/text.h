#pragma once

#include <cstdint>
#include <string>

namespace rayfield::cli {

/// 1234567 → "1 234 567".
std::string grouped(std::uint64_t number);
/// Bytes as "1.2 GiB".
std::string bytes_text(std::uint64_t bytes);

/// A text for a terminal: control characters other than line ends become '?'. Names in a file may hold any bytes.
std::string printable(std::string text);

}  // namespace rayfield::cli
