#include "libdensity/pipeline/layout_store.h"

#include <cmath>

#include "libdensity/layout/layout_arrays.h"

namespace rayfield::density {
namespace {

constexpr int kLayoutVersion = 2;
constexpr const char* kKind = "rows";

// What the layout depends on besides the rays it was found in.
std::string parameters_of(const ProcessOptions& options) {
  KeyBuilder key("layout", kLayoutVersion);
  key.add(option_numbers(options.survey));
  key.add(option_numbers(options.ground));
  key.add(option_numbers(options.canopy));
  key.add(option_numbers(options.rows));
  key.add(option_numbers(options.posts));
  return key.hex();
}

// Entries are named after their parameters, so that a layout of other parameters is told apart without reading it.
std::string entry_name(const ProcessOptions& options) { return parameters_of(options).substr(0, 16); }

Result<BlockLayout> from_entry(const tile::Store& store, const tile::DerivedEntry& entry) {
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, store.read_derived(entry));
  BlockLayout block;
  RAYFIELD_ASSIGN(block.layout, layout_from_arrays(arrays));
  block.known = true;
  block.key = entry.file.sha256;
  return block;
}

}  // namespace

Result<BlockLayout> read_layout(const tile::Store& store, const tile::Snapshot& snapshot) {
  for (const tile::DerivedEntry& entry : snapshot.registry)
    if (entry.kind == kKind) return from_entry(store, entry);
  return BlockLayout{};
}

Result<BlockLayout> load_layout(const tile::Store& store, const tile::Snapshot& snapshot,
                                const ProcessOptions& options) {
  if (options.redo) return BlockLayout{};
  for (const tile::DerivedEntry& entry : snapshot.registry)
    if (entry.kind == kKind && entry.name == entry_name(options)) return from_entry(store, entry);
  return BlockLayout{};
}

Result<void> adopt_layout(ScanWork& work, const SurveyedScan& surveyed, tile::Store::DerivedWriter& writer,
                          BlockLayout& block) {
  KeyBuilder key(parameters_of(work.options), kLayoutVersion);
  for (const tile::TileEntry& entry : work.scan.tiles) key.add(entry.content_sha256());
  Derivation registry(work.store, writer, "", work.options.redo);
  RAYFIELD_ASSIGN(const tile::ArraySet arrays,
                  registry.get(kKind, entry_name(work.options), key.hex(), [&]() -> Result<tile::ArraySet> {
                    RAYFIELD_ASSIGN(FoundLayout found, find_layout(work, surveyed));
                    block.notes = std::move(found.notes);
                    return layout_to_arrays(found.layout);
                  }));
  RAYFIELD_ASSIGN(block.layout, layout_from_arrays(arrays));
  block.key = registry.sha256(kKind, entry_name(work.options));
  block.known = true;
  return registry.finish();
}

}  // namespace rayfield::density
