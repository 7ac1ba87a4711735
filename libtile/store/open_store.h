#pragma once

/// store: the store itself: snapshots, adding scans, reading, derived files, verify and garbage.

#include <filesystem>

#include "libtile/store/checked_files.h"
#include "rayfield/tile/store_config.h"

namespace rayfield::tile {

/// What a Store and the readers and writers that it hands out share.
struct OpenStore {
  OpenStore(std::filesystem::path store_folder, StoreConfig store_config)
      : folder(store_folder), config(std::move(store_config)), files(std::move(store_folder)) {}

  const std::filesystem::path folder;
  const StoreConfig config;
  const CheckedFiles files;
};

}  // namespace rayfield::tile
