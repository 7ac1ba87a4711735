#pragma once

#include <fmt/core.h>

#include <span>
#include <string>
#include <string_view>

#include "rayfield/core/sha256.h"
#include "rayfield/formats/style.h"
#include "rayfield/tile/snapshot.h"
#include "version.h"

namespace rayfield::cli {

/// Everything that a product depends on, as one digest.
class Source {
 public:
  explicit Source(std::string_view product) { add(kVersion).add(product); }
  Source& add(std::string_view text) {
    hash_.update(std::as_bytes(std::span(text)));
    hash_.update(std::string_view("\0", 1));
    return *this;
  }
  Source& add(double number) { return add(fmt::format("{}", number)); }
  std::string hex() { return hash_.hex(); }

 private:
  Sha256 hash_;
};

/// The scan's derived file of that kind and name, by its content.
inline std::string derived_sha256(const tile::ScanEntry& scan, std::string_view kind, std::string_view name) {
  for (const tile::DerivedEntry& entry : scan.derived)
    if (entry.kind == kind && entry.name == name) return entry.file.sha256;
  return {};
}

/// On which colours values lie.
inline std::string scale_source(const formats::ColorScale& scale) {
  return Source("scale").add(scale.low).add(scale.high).hex();
}

}  // namespace rayfield::cli
