#pragma once

#include <cstdint>
#include <string>

namespace rayfield::cli {

/// 1234567 → "1 234 567".
std::string grouped(std::uint64_t number);
/// Bytes as "1.2 GiB".
std::string bytes_text(std::uint64_t bytes);

}  // namespace rayfield::cli
