#include "rayfield/core/uuid.h"

#include "rayfield/core/sha256.h"

namespace rayfield {

std::string named_uuid(std::string_view space, std::string_view name) {
  Sha256 hash;
  hash.update(space);
  hash.update(std::string_view("\0", 1));
  hash.update(name);
  std::string hex = hash.hex().substr(0, 32);
  hex[12] = '8';                                                                // version 8: custom, name-based
  hex[16] = "89ab"[(hex[16] <= '9' ? hex[16] - '0' : hex[16] - 'a' + 10) & 3];  // RFC 4122 variant
  return hex.substr(0, 8) + '-' + hex.substr(8, 4) + '-' + hex.substr(12, 4) + '-' + hex.substr(16, 4) + '-' +
         hex.substr(20, 12);
}

}  // namespace rayfield
