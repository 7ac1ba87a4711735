#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"
#include "rayfield/tile/snapshot.h"

namespace rayfield::tile {

struct OpenStore;

/// A derived file that is read column by column, or part by part where a column is large. Memory is a chunk of 131072
/// elements and what is asked for. For one thread at a time. Made by Store::open_derived().
class ArrayReader {
 public:
  /// Kind, version and attributes, without columns.
  const ArraySet& header() const;
  /// Size of a column of floats. Errors: damaged, if there is none of that name and type.
  Result<std::uint64_t> count(const std::string& column) const;
  /// Elements from `first` on. Errors: damaged, also where the column is shorter; resources.
  Result<void> read(const std::string& column, std::uint64_t first, std::span<float> values) const;
  /// Everything but these columns.
  Result<ArraySet> read_without(const std::vector<std::string>& columns) const;

 private:
  friend class Store;
  /// Checks the file against its SHA-256. Errors: damaged.
  static Result<ArrayReader> open(const OpenStore& store, const DerivedEntry& entry);

  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace rayfield::tile
