#include "tests/fault/damage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace rayfield::tile::testing {
namespace {

std::size_t below(std::size_t end, std::mt19937_64& random) {
  return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
}

std::string flip(std::string& bytes, std::size_t bits, std::mt19937_64& random) {
  std::string how = "bits flipped at";
  for (std::size_t i = 0; i < bits; ++i) {
    const std::size_t at = below(bytes.size(), random);
    bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ (1U << below(8, random)));
    how += fmt::format(" {}", at);
  }
  return how;
}

std::string fill(std::string& bytes, bool zeros, std::mt19937_64& random) {
  static constexpr std::size_t kLengths[] = {1, 16, 512, 4096};
  const std::size_t begin = below(bytes.size(), random);
  const std::size_t end = std::min(bytes.size(), begin + kLengths[below(std::size(kLengths), random)]);
  for (std::size_t i = begin; i < end; ++i) bytes[i] = zeros ? '\0' : static_cast<char>(below(256, random));
  return fmt::format("{} at {} to {}", zeros ? "zeros" : "noise", begin, end);
}

// Half of all damages are single bits, the hardest to notice.
DamagedFile attempt(const std::string& bytes, const std::string& other, std::mt19937_64& random) {
  DamagedFile file{false, bytes, {}};
  const std::size_t kind = bytes.empty() ? 15 : below(16, random);
  if (kind < 8) {
    file.how = flip(file.bytes, 1, random);
  } else if (kind == 8) {
    file.how = flip(file.bytes, 2 + below(4, random), random);
  } else if (kind < 11) {
    file.how = fill(file.bytes, true, random);
  } else if (kind == 11) {
    file.how = fill(file.bytes, false, random);
  } else if (kind == 12) {
    file.bytes.resize(below(bytes.size(), random));
    file.how = fmt::format("cut to {} bytes", file.bytes.size());
  } else if (kind == 13) {
    file.bytes.append(1 + below(100, random), '\0');
    file.how = fmt::format("grown to {} bytes", file.bytes.size());
  } else if (kind == 14) {
    file.bytes = other;
    file.how = "another file's bytes";
  } else {
    file.gone = true;
    file.how = "gone";
  }
  return file;
}

}  // namespace

DamagedFile damaged(const std::string& bytes, const std::string& other, std::mt19937_64& random) {
  for (;;) {
    DamagedFile file = attempt(bytes, other, random);
    if (file.gone || file.bytes != bytes) return file;
  }
}

}  // namespace rayfield::tile::testing
