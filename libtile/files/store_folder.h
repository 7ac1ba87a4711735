#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "rayfield/core/file.h"
#include "rayfield/core/result.h"

/// Folders of a store, opened for what is done to names in them (openat, unlinkat). No symbolic link is followed on the
/// way from the store's own folder: behind one lies what is not the store's to change.
namespace rayfield::tile {

/// An entry of a folder, as it stands there: a link is a link.
struct FolderEntry {
  enum class Kind { file, folder, link, other };
  std::string name;
  Kind kind = Kind::other;
  std::uint64_t size = 0;  ///< of a file
};

/// The store's own folder, which may be reached through links. Errors: resources, bad_input.
Result<FileDescriptor> open_store_folder(const std::filesystem::path& store);
/// The folder `name` in `parent`; `path` is named in errors. Not valid where there is none. Errors: damaged (a link, or
/// no folder), resources.
Result<FileDescriptor> open_folder_in(const FileDescriptor& parent, const std::string& name,
                                      const std::filesystem::path& path);
/// The folder at `relative` below the store, from name to name. Errors: as open_folder_in().
Result<FileDescriptor> open_folder_below(const FileDescriptor& store, const std::filesystem::path& relative,
                                         const std::filesystem::path& store_path);
/// All entries, ordered by name. Errors: resources.
Result<std::vector<FolderEntry>> list_folder(const FileDescriptor& folder, const std::filesystem::path& path);
/// Removes a folder's content, folders in it included. Links in it go, what they lead to stays.
/// Errors: resources.
Result<void> clear_folder(const FileDescriptor& folder, const std::filesystem::path& path);

/// The error of a link, or of something else, that stands where a folder of the store belongs.
tl::unexpected<Error> not_a_folder(const std::filesystem::path& path);
/// Errors: damaged, where scans, registry, snapshots, tmp or trash is something else than a folder of the store itself.
Result<void> check_top_folders(const FileDescriptor& store, const std::filesystem::path& path);

}  // namespace rayfield::tile
