#include "formats/io/base64.h"

#include <cstdint>
#include <string_view>

namespace rayfield::formats {

std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = bytes.size() - i;  // of this and all that follow
    std::uint32_t three = std::to_integer<std::uint32_t>(bytes[i]) << 16U;
    if (count > 1) three |= std::to_integer<std::uint32_t>(bytes[i + 1]) << 8U;
    if (count > 2) three |= std::to_integer<std::uint32_t>(bytes[i + 2]);
    out += kDigits[three >> 18U];
    out += kDigits[three >> 12U & 63U];
    out += count > 1 ? kDigits[three >> 6U & 63U] : '=';
    out += count > 2 ? kDigits[three & 63U] : '=';
  }
  return out;
}

}  // namespace rayfield::formats
