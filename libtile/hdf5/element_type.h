#pragma once

#include <cstddef>
#include <cstdint>

namespace rayfield::tile {

/// Types of numbers that a column of a file can hold; little-endian in the file.
enum class ElementType : std::uint8_t { u8, u16, i32, u32, i64, u64, f32, f64 };

/// Bytes of one element.
constexpr std::size_t element_size(ElementType type) {
  switch (type) {
    case ElementType::u8:
      return 1;
    case ElementType::u16:
      return 2;
    case ElementType::i32:
    case ElementType::u32:
    case ElementType::f32:
      return 4;
    case ElementType::i64:
    case ElementType::u64:
    case ElementType::f64:
      return 8;
  }
  return 1;
}

}  // namespace rayfield::tile
