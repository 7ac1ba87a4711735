#include "cli/console/needs.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <system_error>

#include "cli/console/text.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

// Of the nearest folder that is there.
std::optional<std::uint64_t> free_bytes(const fs::path& folder) {
  std::error_code error;
  fs::path there = fs::absolute(folder.empty() ? fs::path(".") : folder, error);
  while (!error && !fs::exists(there, error) && there.has_relative_path()) there = there.parent_path();
  const fs::space_info space = fs::space(there, error);
  if (error) return std::nullopt;
  return space.available;
}

}  // namespace

// Commands run one after the other: what stays adds up, what is needed meanwhile does not.
Needs operator+(const Needs& a, const Needs& b) {
  return {a.disk_bytes + b.disk_bytes, std::max(a.temporary_bytes, b.temporary_bytes),
          std::max(a.memory_bytes, b.memory_bytes)};
}

void add_needs(const Needs& needs, const fs::path& folder, Outcome& outcome) {
  outcome.data["disk_bytes"] = needs.disk_bytes;
  outcome.data["temporary_bytes"] = needs.temporary_bytes;
  outcome.data["memory_bytes"] = needs.memory_bytes;
  const auto free = free_bytes(folder);
  outcome.data["free_bytes"] = free ? nlohmann::ordered_json(*free) : nlohmann::ordered_json(nullptr);
  outcome.text += fmt::format("  disk: about {}", bytes_text(needs.disk_bytes));
  if (needs.temporary_bytes > 0)
    outcome.text += fmt::format(", {} more while it runs", bytes_text(needs.temporary_bytes));
  if (free) outcome.text += fmt::format("; {} are free", bytes_text(*free));
  outcome.text += fmt::format("\n  memory: up to {}\n", bytes_text(needs.memory_bytes));
  if (free && needs.disk_bytes + needs.temporary_bytes > *free) outcome.text += "  there is not enough free space\n";
}

}  // namespace rayfield::cli
