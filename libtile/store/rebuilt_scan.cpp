#include "libtile/store/rebuilt_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "libtile/files/file_io.h"
#include "libtile/files/store_folder.h"
#include "libtile/files/store_layout.h"
#include "libtile/hdf5/seal.h"
#include "libtile/store/snapshot_json.h"
#include "libtile/tile_file/tile_file.h"
#include "rayfield/core/date.h"
#include "rayfield/core/sha256.h"

namespace rayfield::tile {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWhat = "cannot rebuild the scan";
constexpr std::size_t kDateLength = 10, kDigestLength = 16;
constexpr const char* kAlignmentFile = "alignment.json";

// Files of our own in a folder of the store that are not in `named`.
Result<std::vector<std::string>> own_files(const fs::path& store, const std::string& directory,
                                           const std::set<std::string>& named) {
  RAYFIELD_ASSIGN(const FileDescriptor top, open_store_folder(store));
  RAYFIELD_ASSIGN(const FileDescriptor folder, open_folder_below(top, directory, store));
  std::vector<std::string> paths;
  if (!folder.valid()) return paths;
  RAYFIELD_ASSIGN(const std::vector<FolderEntry> entries, list_folder(folder, store / directory));
  for (const FolderEntry& entry : entries) {
    const std::string path = directory + "/" + entry.name;
    if (entry.kind == FolderEntry::Kind::file && layout::is_own_file(directory, entry.name) && !named.contains(path))
      paths.push_back(path);
  }
  return paths;
}

// The file's entry, where its bytes agree with the digest in its name.
Result<std::optional<FileEntry>> sound_entry(const fs::path& store, const std::string& path, bool sealed,
                                             std::string* content = nullptr) {
  RAYFIELD_ASSIGN(const std::vector<std::byte> bytes, read_file(store / path, kWhat));
  FileEntry entry{path, bytes.size(), sha256_hex(bytes)};
  if (path.find("." + entry.sha256.substr(0, kDigestLength)) == std::string::npos || (sealed && !is_sealed(bytes)))
    return std::optional<FileEntry>();
  if (content != nullptr) content->assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return std::optional(std::move(entry));
}

struct Parts {
  std::map<std::uint32_t, FileEntry> files;
  std::uint64_t segments = 0;
};

Result<std::map<TileIndex, Parts>> sound_tiles(const Store& store, const std::string& scan_id,
                                               const std::vector<std::string>& paths, const Progress& progress) {
  std::map<TileIndex, Parts> tiles;
  for (const std::string& path : paths) {
    if (progress.cancelled())
      return fail(ErrorCode::interrupted, "interrupted", store.folder().string(), "", "run the same command again");
    RAYFIELD_ASSIGN(const auto entry, sound_entry(store.folder(), path, true));
    if (!entry) continue;  // a torn file, which no snapshot has ever named
    RAYFIELD_ASSIGN(const TilePart part, read_tile_part(store.folder() / path));
    Parts& tile = tiles[part.header.index];
    tile.segments += part.header.segments;
    if (!tile.files.emplace(part.header.part, *entry).second)
      return fail(ErrorCode::damaged, kWhat, scan_id,
                  fmt::format("tile {}_{} is there in two versions", part.header.index.ix, part.header.index.iy),
                  "add it again");
  }
  return tiles;
}

struct RayTotals {
  std::uint64_t ends = 0;
  double first_s = std::numeric_limits<double>::infinity(), last_s = -std::numeric_limits<double>::infinity();
};

// Counts what the writer counted when it made the tile.
Result<void> count_segments(const Store& store, TileEntry& tile, ScanEntry& scan, RayTotals& totals) {
  RAYFIELD_ASSIGN(const TileReader reader, store.open_tile(tile));
  SegmentBatch segments;
  for (std::size_t chunk = 0; chunk < reader.chunk_count(); ++chunk) {
    RAYFIELD_CHECK(reader.read_chunk(chunk, segments));
    for (std::size_t i = 0; i < segments.size(); ++i) {
      const std::uint8_t flags = segments.flags[i];
      tile.bounds.extend(segments.entry[i]);
      tile.bounds.extend(segments.exit[i]);
      totals.ends += (flags & kEndsHere) != 0 ? 1 : 0;
      tile.hit_count += (flags & kHit) != 0 && (flags & kEndsHere) != 0 ? 1 : 0;
      if ((flags & kStartsHere) == 0) continue;
      ++tile.start_count;
      scan.origin_bounds.extend(segments.entry[i]);
      totals.first_s = std::min(totals.first_s, segments.time_s[i]);
      totals.last_s = std::max(totals.last_s, segments.time_s[i]);
    }
  }
  scan.ray_count += tile.start_count;
  scan.hit_count += tile.hit_count;
  return {};
}

Result<void> add_tiles(const Store& store, const std::map<TileIndex, Parts>& tiles, ScanEntry& scan) {
  RayTotals totals;
  for (const auto& [index, parts] : tiles) {
    TileEntry tile;
    tile.index = index;
    tile.segment_count = parts.segments;
    for (const auto& [part, file] : parts.files) {
      if (part == 0) tile.file = file;
      if (part > 0) tile.more_files.push_back(file);
    }
    RAYFIELD_CHECK(count_segments(store, tile, scan, totals));
    scan.tiles.push_back(std::move(tile));
  }
  // Every ray starts once and ends once: where tiles are missing, the numbers differ.
  if (scan.ray_count == 0 || scan.ray_count != totals.ends)
    return fail(
        ErrorCode::damaged, kWhat, scan.scan_id,
        fmt::format("{} rays start in its tiles and {} end there: tiles are missing", scan.ray_count, totals.ends),
        "add it again");
  scan.start_time_s = totals.first_s, scan.end_time_s = totals.last_s;
  return {};
}

Result<void> add_attachments(const Store& store, const std::set<std::string>& named, ScanEntry& scan) {
  const std::string directory = layout::attachment_directory(scan.scan_id);
  RAYFIELD_ASSIGN(const std::vector<std::string> paths, own_files(store.folder(), directory, named));
  std::set<std::string> names;
  for (const std::string& path : paths) {
    std::string content;
    RAYFIELD_ASSIGN(const auto entry, sound_entry(store.folder(), path, false, &content));
    if (!entry) continue;
    std::string name = fs::path(path).filename().string();
    name.erase(name.find('.'), 1 + kDigestLength);
    if (!names.insert(name).second)
      return fail(ErrorCode::damaged, kWhat, scan.scan_id, name + " is there in two versions", "add it again");
    if (name == kAlignmentFile) scan.alignment = alignment_from_file(content);
    scan.attachments.push_back({name, *entry});
  }
  std::sort(scan.attachments.begin(), scan.attachments.end(),
            [](const AttachmentEntry& a, const AttachmentEntry& b) { return a.name < b.name; });
  return {};
}

}  // namespace

Result<ScanEntry> rebuild_scan(const Store& store, const std::string& scan_id, const std::set<std::string>& named,
                               Progress& progress) {
  ScanEntry scan;
  scan.scan_id = scan_id;
  scan.date = scan_id.substr(0, kDateLength);
  if (!parse_date(scan.date) || (scan_id.size() > kDateLength && scan_id[kDateLength] != '_'))
    return fail(ErrorCode::damaged, kWhat, scan_id, "it is no id of a scan", "look at the folder");
  if (scan_id.size() > kDateLength) scan.name = scan_id.substr(kDateLength + 1);
  RAYFIELD_ASSIGN(const auto paths, own_files(store.folder(), layout::rays_directory(scan_id), named));
  RAYFIELD_ASSIGN(const auto tiles, sound_tiles(store, scan_id, paths, progress));
  RAYFIELD_CHECK(add_tiles(store, tiles, scan));
  RAYFIELD_CHECK(add_attachments(store, named, scan));
  scan.warnings.emplace_back(
      "made again from its tiles by `rayfield repair`: its inputs, its beam and whether it is dormant are not known");
  return scan;
}

Result<std::vector<DerivedEntry>> rebuild_registry(const Store& store, std::vector<std::string>& left_out) {
  RAYFIELD_ASSIGN(const FileDescriptor top, open_store_folder(store.folder()));
  RAYFIELD_ASSIGN(const FileDescriptor folder,
                  open_folder_in(top, layout::kRegistry, store.folder() / layout::kRegistry));
  std::map<std::pair<std::string, std::string>, std::vector<DerivedEntry>> found;
  if (!folder.valid()) return std::vector<DerivedEntry>();
  RAYFIELD_ASSIGN(const auto kinds, list_folder(folder, store.folder() / layout::kRegistry));
  for (const FolderEntry& kind : kinds) {
    if (kind.kind != FolderEntry::Kind::folder || !layout::is_plain_name(kind.name)) continue;
    RAYFIELD_ASSIGN(const auto paths, own_files(store.folder(), layout::derived_directory("", kind.name), {}));
    for (const std::string& path : paths) {
      RAYFIELD_ASSIGN(const auto entry, sound_entry(store.folder(), path, true));
      if (!entry) continue;
      // "<name>.<key16>.<sha16>.h5"
      const std::string name = fs::path(path).filename().string();
      const std::size_t end = name.size() - 2 * (kDigestLength + 1) - 3;
      found[{kind.name, name.substr(0, end)}].push_back(
          {kind.name, name.substr(0, end), name.substr(end + 1, kDigestLength), *entry});
    }
  }
  std::vector<DerivedEntry> registry;
  for (auto& [name, entries] : found) {
    if (entries.size() == 1) registry.push_back(std::move(entries.front()));
    if (entries.size() > 1) left_out.push_back(name.first + "/" + name.second);
  }
  return registry;
}

}  // namespace rayfield::tile
