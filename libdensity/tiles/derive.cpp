#include "libdensity/tiles/derive.h"

#include <algorithm>
#include <bit>
#include <span>

namespace rayfield::density {
namespace {

template <class T>
void update(Sha256& hash, const T& value) {
  hash.update(std::as_bytes(std::span<const T>(&value, 1)));
}

}  // namespace

KeyBuilder::KeyBuilder(std::string_view stage, int code_version) {
  add(stage).add(static_cast<std::int64_t>(code_version));
}

KeyBuilder& KeyBuilder::add(std::string_view text) {
  update(hash_, static_cast<std::uint64_t>(text.size()));
  hash_.update(text);
  return *this;
}

KeyBuilder& KeyBuilder::add(double number) {
  update(hash_, std::bit_cast<std::uint64_t>(number));
  return *this;
}

KeyBuilder& KeyBuilder::add(std::int64_t number) {
  update(hash_, number);
  return *this;
}

KeyBuilder& KeyBuilder::add(const std::vector<double>& numbers) {
  update(hash_, static_cast<std::uint64_t>(numbers.size()));
  for (const double number : numbers) add(number);
  return *this;
}

Derivation::Derivation(const tile::Store& store, tile::Store::DerivedWriter& writer, std::string scan_id, bool redo)
    : store_(store), writer_(writer), scan_id_(std::move(scan_id)), redo_(redo) {}

void Derivation::keep(const tile::DerivedEntry& entry, bool made) {
  const std::lock_guard lock(mutex_);
  entries_[{entry.kind, entry.name}] = entry;
  ++(made ? total_.made : total_.kept);
}

bool Derivation::has_all(const std::vector<tile::DerivedEntry>& entries) const {
  return !redo_ && std::all_of(entries.begin(), entries.end(), [&](const tile::DerivedEntry& entry) {
    const auto found = writer_.find({scan_id_, entry.kind, entry.name, entry.key});
    return found && found->file.sha256 == entry.file.sha256;
  });
}

tile::DerivedEntry Derivation::entry(const std::string& kind, const std::string& name) const {
  const std::lock_guard lock(mutex_);
  return entries_.at({kind, name});
}

std::string Derivation::sha256(const std::string& kind, const std::string& name) const {
  return entry(kind, name).file.sha256;
}

Result<tile::ArraySet> Derivation::read(const std::string& kind, const std::string& name) const {
  return store_.read_derived(entry(kind, name));
}

Result<tile::ArrayReader> Derivation::open(const std::string& kind, const std::string& name) const {
  return store_.open_derived(entry(kind, name));
}

StageCount Derivation::total() const {
  const std::lock_guard lock(mutex_);
  return total_;
}

Result<void> Derivation::finish() {
  const std::lock_guard lock(mutex_);
  std::vector<tile::DerivedEntry> entries;
  for (const auto& [place, entry] : entries_) entries.push_back(entry);
  return writer_.set(scan_id_, std::move(entries));
}

std::string tile_name(tile::TileIndex index) { return std::to_string(index.ix) + "_" + std::to_string(index.iy); }

}  // namespace rayfield::density
