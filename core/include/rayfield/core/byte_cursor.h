#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace rayfield {

static_assert(std::endian::native == std::endian::little, "the readers copy little-endian numbers as they are");

/// Reads little-endian numbers from a span. A read past the end gives zeros and sets failed(), so that a decoder can
/// read a whole message and ask once.
class ByteCursor {
 public:
  explicit ByteCursor(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  T get() {
    static_assert(std::is_arithmetic_v<T>);
    T value{};
    const std::span<const std::byte> from = take(sizeof(T));
    if (from.size() == sizeof(T)) std::memcpy(&value, from.data(), sizeof(T));
    return value;
  }
  /// The next `count` bytes, or none (and failed()) where fewer are left.
  std::span<const std::byte> take(std::size_t count) {
    if (count > bytes_.size() - at_) {
      failed_ = true;
      at_ = bytes_.size();
      return {};
    }
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }
  void skip(std::size_t count) { take(count); }
  /// A string or byte array with its length in front.
  std::span<const std::byte> take_counted() { return take(get<std::uint32_t>()); }
  std::string_view text() {
    const std::span<const std::byte> bytes = take_counted();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  /// An array of numbers with its length in front, as raw bytes (they may be unaligned).
  template <class T>
  std::span<const std::byte> take_array() {
    const std::size_t count = get<std::uint32_t>();
    if (count > remaining() / sizeof(T)) {
      failed_ = true;
      at_ = bytes_.size();
      return {};
    }
    return take(count * sizeof(T));
  }
  std::size_t remaining() const { return bytes_.size() - at_; }
  bool failed() const { return failed_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool failed_ = false;
};

/// A number at any byte offset; the caller has checked that it lies inside.
template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

/// Appends numbers in little-endian order.
class ByteBuilder {
 public:
  template <class T>
  void put(T value) {
    static_assert(std::is_arithmetic_v<T>);
    raw(std::as_bytes(std::span<const T, 1>(&value, 1)));
  }
  // Inlined into its callers, GCC 12 reports overflows here that cannot happen.
  [[gnu::noinline]] void raw(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void raw(std::string_view text) { raw(std::as_bytes(std::span<const char>(text.data(), text.size()))); }
  /// A string with its length in front.
  void text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    raw(text);
  }
  std::span<const std::byte> bytes() const { return bytes_; }
  std::size_t size() const { return bytes_.size(); }
  void clear() { bytes_.clear(); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace rayfield
