#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace rayfield::tile {

/// A whole number of JSON that fits into T. Conversions of nlohmann's take 1e92 and what does not fit, which C++ leaves
/// undefined. Throws std::runtime_error.
template <class T, class Json>
T whole_number(const Json& json) {
  static_assert(std::is_integral_v<T>);
  const auto refuse = [&] { throw std::runtime_error(json.dump() + " is no whole number of the size that is due"); };
  if (!json.is_number_integer()) refuse();
  if (json.is_number_unsigned()) {
    const auto number = json.template get<std::uint64_t>();
    if (number > static_cast<std::uint64_t>(std::numeric_limits<T>::max())) refuse();
    return static_cast<T>(number);
  }
  const auto number = json.template get<std::int64_t>();
  if constexpr (std::is_unsigned_v<T>) {
    if (number < 0) refuse();
  } else if (number < static_cast<std::int64_t>(std::numeric_limits<T>::min()) ||
             number > static_cast<std::int64_t>(std::numeric_limits<T>::max())) {
    refuse();
  }
  return static_cast<T>(number);
}

}  // namespace rayfield::tile
