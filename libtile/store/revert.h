#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

namespace rayfield::tile {

/// Store::revert(): lock, check that the old snapshot's files are there, publish its content as a new snapshot.
Result<RevertReport> revert_store(const std::filesystem::path& store, std::uint64_t number, const std::string& command);

}  // namespace rayfield::tile
