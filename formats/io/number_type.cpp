#include "formats/io/number_type.h"

namespace rayfield::formats {

std::size_t number_bytes(NumberType type) {
  switch (type) {
    case NumberType::i8:
    case NumberType::u8:
      return 1;
    case NumberType::i16:
    case NumberType::u16:
      return 2;
    case NumberType::i32:
    case NumberType::u32:
    case NumberType::f32:
      return 4;
    case NumberType::f64:
      return 8;
  }
  return 0;
}

}  // namespace rayfield::formats
