#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
/// identity: what names a content or a thing: SHA-256 and UUIDs.
namespace rayfield {

/// Incremental SHA-256 (FIPS 180-4, through libcrypto).
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;
  void update(std::span<const std::byte> bytes);
  void update(std::string_view text);
  /// 64 lower-case hexadecimal digits; the object is then finished.
  std::string hex();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

std::string sha256_hex(std::span<const std::byte> bytes);
std::string sha256_hex(std::string_view text);

}  // namespace rayfield
