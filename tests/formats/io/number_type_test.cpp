#include "formats/io/number_type.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace rayfield::formats {
namespace {

template <class T>
double round_trip(T value, NumberType type) {
  EXPECT_EQ(number_bytes(type), sizeof(T));
  std::byte bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  return load_number(bytes, type);
}

TEST(NumberType, ReadsEveryTypeExactly) {
  EXPECT_EQ(round_trip(std::int8_t{-100}, NumberType::i8), -100.0);
  EXPECT_EQ(round_trip(std::uint8_t{200}, NumberType::u8), 200.0);
  EXPECT_EQ(round_trip(std::int16_t{-30000}, NumberType::i16), -30000.0);
  EXPECT_EQ(round_trip(std::uint16_t{60000}, NumberType::u16), 60000.0);
  EXPECT_EQ(round_trip(std::int32_t{-2000000000}, NumberType::i32), -2e9);
  EXPECT_EQ(round_trip(std::uint32_t{4000000000}, NumberType::u32), 4e9);
  EXPECT_EQ(round_trip(0.5F, NumberType::f32), 0.5);
  EXPECT_EQ(round_trip(1e-300, NumberType::f64), 1e-300);
}

TEST(NumberType, KnowsWhichValuesAreNoType) {
  const std::byte bytes[8] = {};
  for (const auto type : {static_cast<NumberType>(0), static_cast<NumberType>(9)}) {
    EXPECT_EQ(number_bytes(type), 0U);
    EXPECT_TRUE(std::isnan(load_number(bytes, type)));
  }
}

}  // namespace
}  // namespace rayfield::formats
