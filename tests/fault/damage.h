#pragma once

#include <random>
#include <string>

namespace rayfield::tile::testing {

/// What may become of a file: gone, or other bytes than before.
struct DamagedFile {
  bool gone = false;
  std::string bytes, how;  ///< `how`: in words, with the place
};

/// Bits flipped, bytes cut off, emptied, filled with zeros or with anything, added, or those of another file. Never the
/// bytes that were there. `other`: bytes of a file of the same kind.
DamagedFile damaged(const std::string& bytes, const std::string& other, std::mt19937_64& random);

}  // namespace rayfield::tile::testing
