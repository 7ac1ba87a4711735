#pragma once

#include <cstdint>
#include <filesystem>

#include "cli/console/common_options.h"

namespace rayfield::cli {

/// What a command would need from the machine, as --dry-run prints it (docs/commands.md, "Dry runs").
struct Needs {
  std::uint64_t disk_bytes = 0;       ///< that stay
  std::uint64_t temporary_bytes = 0;  ///< more while it runs
  std::uint64_t memory_bytes = 0;     ///< resident, at most
};
Needs operator+(const Needs& a, const Needs& b);

/// Adds them to what a dry run says: "disk_bytes", "temporary_bytes", "memory_bytes" and "free_bytes" of the file
/// system that `folder` lies on or will lie on; and says so where there is not enough.
void add_needs(const Needs& needs, const std::filesystem::path& folder, Outcome& outcome);

}  // namespace rayfield::cli
