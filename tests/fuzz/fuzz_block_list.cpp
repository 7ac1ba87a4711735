#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "cli/blocks/block_list.h"

/// Whatever the text of a list of blocks: an error with its reason, or blocks that have all that an update needs.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto blocks = rayfield::cli::parse_block_list({reinterpret_cast<const char*>(data), size}, "folder/list.toml");
  if (!blocks) {
    if (blocks.error().why.empty()) std::abort();
    return 0;
  }
  if (blocks->empty()) std::abort();
  for (const auto& block : *blocks) {
    if (block.store.empty() || block.inputs.files.empty() || block.date.size() != 10) std::abort();
  }
  return 0;
}
