#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rayfield/core/sha256.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

/// Hash of everything that a derived file depends on.
class KeyBuilder {
 public:
  /// `code_version`: raised whenever the code computes something else from the same input.
  KeyBuilder(std::string_view stage, int code_version);
  KeyBuilder& add(std::string_view text);
  KeyBuilder& add(double number);
  KeyBuilder& add(std::int64_t number);
  KeyBuilder& add(const std::vector<double>& numbers);
  std::string hex() { return hash_.hex(); }

 private:
  Sha256 hash_;
};

/// What became of the files.
struct StageCount {
  std::size_t made = 0, kept = 0;
};

/// The derived files of a scan (or of the block) while they are being made: takes what is there already under the same
/// key, makes the rest, and remembers the complete set for DerivedWriter::set(). Safe to use from several threads.
class Derivation {
 public:
  Derivation(const tile::Store& store, tile::Store::DerivedWriter& writer, std::string scan_id, bool redo);

  /// The file of that kind, name and key: read if it is there, else made by `make` (→ Result<ArraySet>) and written.
  template <class Make>
  Result<tile::ArraySet> get(const std::string& kind, const std::string& name, const std::string& key, Make&& make) {
    const tile::NewDerived what{scan_id_, kind, name, key};
    if (!redo_) {
      if (const auto found = writer_.find(what)) {
        Result<tile::ArraySet> arrays = store_.read_derived(*found);
        if (arrays) {
          keep(*found, false);
          return arrays;
        }
      }
    }
    Result<tile::ArraySet> arrays = make();
    if (!arrays) return arrays;
    Result<tile::DerivedEntry> entry = writer_.put(what, *arrays);
    if (!entry) return tl::make_unexpected(std::move(entry).error());
    keep(*entry, true);
    return arrays;
  }

  /// Sees to it that there is such a file, as get() does, without reading it. `make` → Result<StreamedArrays>.
  template <class Make>
  Result<void> ensure(const std::string& kind, const std::string& name, const std::string& key, Make&& make) {
    const tile::NewDerived what{scan_id_, kind, name, key};
    if (!redo_) {
      if (const auto found = writer_.find(what)) {
        keep(*found, false);
        return {};
      }
    }
    Result<tile::StreamedArrays> arrays = make();
    if (!arrays) return tl::make_unexpected(std::move(arrays).error());
    Result<tile::DerivedEntry> entry = writer_.put(what, *arrays);
    if (!entry) return tl::make_unexpected(std::move(entry).error());
    keep(*entry, true);
    return {};
  }

  /// To take files of another scan by their keys. What is made there is not published.
  Derivation for_scan(std::string scan_id) const { return {store_, writer_, std::move(scan_id), false}; }

  /// SHA-256 of the file made or kept under that kind and name.
  std::string sha256(const std::string& kind, const std::string& name) const;

  tile::DerivedEntry entry(const std::string& kind, const std::string& name) const;

  /// Whether these files are there, undamaged, and may be used: not if everything is to be computed again.
  bool has_all(const std::vector<tile::DerivedEntry>& entries) const;

  /// Takes a file of the store into the set as it is.
  void take(const tile::DerivedEntry& entry) { keep(entry, false); }

  /// The file made or kept under that kind and name, read again.
  Result<tile::ArraySet> read(const std::string& kind, const std::string& name) const;

  /// The same, to be read part by part.
  Result<tile::ArrayReader> open(const std::string& kind, const std::string& name) const;

  /// Where files without a name may be made while the work goes on.
  std::filesystem::path scratch_folder() const { return writer_.scratch_folder(); }

  /// Publishes the set with the writer.
  Result<void> finish();
  StageCount total() const;

 private:
  void keep(const tile::DerivedEntry& entry, bool made);

  const tile::Store& store_;
  tile::Store::DerivedWriter& writer_;
  std::string scan_id_;
  bool redo_;
  mutable std::mutex mutex_;
  std::map<std::pair<std::string, std::string>, tile::DerivedEntry> entries_;  // by kind and name
  StageCount total_;
};

/// "12_-7"
std::string tile_name(tile::TileIndex index);

}  // namespace rayfield::density
