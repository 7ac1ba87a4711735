#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "rayfield/core/text_file.h"
#include "rayfield/sim/site_toml.h"

/// Whatever the text of a SITE.toml: an error with its reason, or a site.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto site = rayfield::sim::parse_site({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (site) {
    if (site->dates.empty()) std::abort();
  } else if (site.error().why.empty()) {
    std::abort();
  }
  return 0;
}
