#pragma once

#include <filesystem>
#include <random>
#include <string>

namespace rayfield::tile::testing {

/// Changes values in a derived file, a tile or the newest snapshot of a store, and seals all that it changed, so that
/// every digest fits: what somebody can do who means harm. Says what was changed.
std::string reseal_changed(const std::filesystem::path& store, std::mt19937_64& random);

}  // namespace rayfield::tile::testing
