#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace rayfield::formats {

/// RFC 4648, with padding, without line breaks.
std::string base64(std::span<const std::byte> bytes);

}  // namespace rayfield::formats
