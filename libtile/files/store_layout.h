#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "rayfield/core/result.h"
#include "rayfield/tile/segments.h"

/// Where things lie in a store (docs/store-format.md).
namespace rayfield::tile::layout {

inline constexpr const char* kStoreFile = "store.json";
inline constexpr const char* kLock = "lock";
inline constexpr const char* kTemporary = "tmp";
inline constexpr const char* kTrash = "trash";
inline constexpr const char* kSnapshots = "snapshots";
inline constexpr const char* kScans = "scans";
inline constexpr const char* kRegistry = "registry";
inline constexpr const char* kRays = "rays";
inline constexpr const char* kAttachments = "files";

std::string rays_directory(const std::string& scan_id);
std::string tile_file_name(TileIndex index, const std::string& sha256);
std::string attachment_directory(const std::string& scan_id);
/// "slam.json" → "slam.<sha16>.json": what opens the one opens the other.
std::string attachment_file_name(const std::string& name, const std::string& sha256);
/// `scan_id` empty: the registry.
std::string derived_directory(const std::string& scan_id, const std::string& kind);
/// The part of a derived file's name that its name and key determine.
std::string derived_prefix(const std::string& name, const std::string& key);
std::string derived_file_name(const std::string& name, const std::string& key, const std::string& sha256);
std::string snapshot_file_name(std::uint64_t number);

/// scan_id of a date and an optional label: characters that do not belong in a folder's name become '-'.
/// Errors: usage.
Result<std::string> scan_id(const std::string& date, const std::string& name);

/// Can stand as one component of a path: letters, digits, '.', '_', '-', not starting with '.'.
bool is_plain_name(std::string_view text);
/// A path of a file that stays inside the store: relative, without ".." and not ending in a slash.
bool is_inside(const std::string& path);

/// Names that this program gives to files, and nobody else by chance. What bears another name is not the store's.
/// `directory`: "scans/<scan_id>/<kind>" or "registry/<kind>".
bool is_own_file(const std::filesystem::path& directory, std::string_view name);
/// In tmp/: files that are being written, spill files, and scratch folders of programs that align a scan.
bool is_own_temporary_file(std::string_view name);
bool is_own_scratch_folder(std::string_view name);

}  // namespace rayfield::tile::layout
