#include "tests/fault/reseal.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "libtile/files/sealed_json.h"
#include "libtile/files/store_layout.h"
#include "libtile/hdf5/array_image.h"
#include "libtile/hdf5/seal.h"
#include "libtile/store/snapshot_json.h"
#include "rayfield/core/sha256.h"
#include "rayfield/tile/store.h"
#include "tests/libtile/hdf5/resealed.h"

namespace rayfield::tile::testing {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Random = std::mt19937_64;

std::size_t below(std::size_t end, Random& random) {
  return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
}

std::vector<std::byte> bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

void write(const fs::path& path, std::span<const std::byte> bytes) {
  fs::remove(path);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

// One value of a document becomes one that no program writes there.
std::string change_value(Json& document, Random& random) {
  static const Json kStrange = Json::parse(
      R"([0, -1, 1e300, -1e300, 4e9, -9223372036854775808, 18446744073709551615, 1e-300, null, "", "..", "a/b",
          "nan", [], {}, [[1]], true, "\u0000", "1e9"])");
  const Json flat = document.flatten();
  if (flat.empty()) return "nothing";
  const auto leaf = std::next(flat.begin(), static_cast<std::ptrdiff_t>(below(flat.size(), random)));
  const Json& value = kStrange[below(kStrange.size(), random)];
  document[Json::json_pointer(leaf.key())] = value;
  return fmt::format("{} = {}", leaf.key(), value.dump());
}

template <class T>
T strange(Random& random) {
  using Limits = std::numeric_limits<T>;
  const T values[] = {T(0),
                      T(1),
                      static_cast<T>(-1),
                      Limits::max(),
                      Limits::lowest(),
                      Limits::infinity(),
                      Limits::quiet_NaN(),
                      static_cast<T>(100000),
                      static_cast<T>(random())};
  return values[below(std::size(values), random)];
}

template <class T>
std::string change_values(std::vector<T>& values, Random& random) {
  const std::size_t how = below(8, random);
  if (how == 0 || values.empty()) return values.push_back(strange<T>(random)), "one more";
  if (how == 1) return values.resize(below(values.size(), random)), fmt::format("cut to {}", values.size());
  const T value = strange<T>(random);
  if (how == 2) return values.assign(values.size(), value), fmt::format("all {}", value);
  std::size_t at = 0;
  for (std::size_t n = how < 6 ? 1 : 20; n > 0; --n) values[at = below(values.size(), random)] = value;
  return fmt::format("{} at {}", value, at);
}

std::string change_arrays(ArraySet& arrays, Random& random) {
  if (arrays.columns.empty() || below(4, random) == 0) {
    Json attributes = Json::parse(arrays.attributes, nullptr, false);
    if (!attributes.is_object()) attributes = Json::object();
    const std::string how = change_value(attributes, random);
    arrays.attributes = attributes.dump();
    return "attribute " + how;
  }
  auto& [name, column] =
      *std::next(arrays.columns.begin(), static_cast<std::ptrdiff_t>(below(arrays.columns.size(), random)));
  return name + ": " + std::visit([&](auto& values) { return change_values(values, random); }, column);
}

std::string change_image(std::vector<std::byte>& file, Random& random) {
  std::vector<std::byte> image(file.begin(), file.end() - static_cast<std::ptrdiff_t>(kSealSize));
  std::string how = "image bits";
  for (std::size_t n = 1 + below(3, random); n > 0; --n) {
    const std::size_t at = below(image.size(), random);
    image[at] ^= std::byte(1U << below(8, random));
    how += fmt::format(" {}", at);
  }
  file = resealed(image);
  return how;
}

// A file whose name holds its own digest gets a new name.
void replace_file(const fs::path& store, Snapshot& snapshot, const std::string& path,
                  std::span<const std::byte> bytes) {
  FileEntry entry{path, bytes.size(), sha256_hex(bytes)};
  const std::size_t end = path.rfind('.');
  entry.path.replace(end - 16, 16, entry.sha256.substr(0, 16));
  write(store / entry.path, bytes);
  const auto renew = [&](FileEntry& file) {
    if (file.path == path) file = entry;
  };
  for (DerivedEntry& derived : snapshot.registry) renew(derived.file);
  for (ScanEntry& scan : snapshot.scans) {
    for (DerivedEntry& derived : scan.derived) renew(derived.file);
    for (TileEntry& tile : scan.tiles) renew(tile.file);
  }
}

// Paths of derived files, and of tiles now and then: one of each kind has the same chance.
std::string some_path(const Snapshot& snapshot, Random& random) {
  std::map<std::string, std::vector<std::string>> kinds;
  for (const DerivedEntry& derived : snapshot.registry) kinds[derived.kind].push_back(derived.file.path);
  for (const ScanEntry& scan : snapshot.scans) {
    for (const DerivedEntry& derived : scan.derived) kinds[derived.kind].push_back(derived.file.path);
    for (const TileEntry& tile : scan.tiles) kinds["rays"].push_back(tile.file.path);
  }
  const auto& paths = std::next(kinds.begin(), static_cast<std::ptrdiff_t>(below(kinds.size(), random)))->second;
  return paths[below(paths.size(), random)];
}

}  // namespace

std::string reseal_changed(const fs::path& store, Random& random) {
  Snapshot snapshot = Store::open(store).value().latest().value();
  std::string path, how;
  const bool in_snapshot = below(5, random) == 0;
  if (!in_snapshot) {
    path = some_path(snapshot, random);
    std::vector<std::byte> file = bytes_of(store / path);
    const bool columns = path.find("/rays/") == std::string::npos && below(4, random) != 0;
    if (columns) {
      ArraySet arrays = decode_arrays(file, path).value();
      how = change_arrays(arrays, random);
      file = encode_arrays(arrays).value();
    } else {
      how = change_image(file, random);
    }
    replace_file(store, snapshot, path, file);
  }
  Json json = to_json(snapshot);
  if (in_snapshot) path = "snapshot", how = change_value(json, random);
  const std::string text = seal_json("snapshot", json);
  write(store / layout::kSnapshots / layout::snapshot_file_name(snapshot.number), std::as_bytes(std::span(text)));
  return path + ": " + how;
}

}  // namespace rayfield::tile::testing
