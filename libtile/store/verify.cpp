#include "libtile/store/verify.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <tuple>

#include "libtile/files/sealed_json.h"
#include "libtile/files/store_folder.h"
#include "libtile/files/store_layout.h"
#include "libtile/store/snapshot_chain.h"
#include "rayfield/core/file.h"
#include "rayfield/core/parallel.h"

namespace rayfield::tile {
namespace {

// What is wrong with a file; nothing where it is as the entry says. Errors: interrupted, resources.
Result<std::optional<std::string>> problem_of(const std::filesystem::path& store, const FileEntry& file,
                                              const std::function<bool()>& cancelled) {
  const auto other_size = [&file](std::uint64_t size) {
    return "it has " + std::to_string(size) + " bytes instead of " + std::to_string(file.size);
  };
  std::error_code ignored;
  // Before it is read: a sparse file may claim any size.
  const std::uint64_t size = std::filesystem::file_size(store / file.path, ignored);
  if (!ignored && size != file.size) return other_size(size);
  const auto digest = digest_file((store / file.path).string(), "cannot read", cancelled);
  if (!digest && digest.error().code == ErrorCode::interrupted)
    return fail(ErrorCode::interrupted, "interrupted", store.string(), "not all files were checked");
  // A disk that cannot read a file has damaged it, and the others are looked at; no descriptor or memory says nothing.
  if (!digest && digest.error().code == ErrorCode::resources && digest.error().why != std::strerror(EIO))
    return tl::make_unexpected(digest.error());
  if (!digest && !std::filesystem::exists(store / file.path, ignored)) return "the file is missing";
  if (!digest) return digest.error().why;
  if (digest->size != file.size) return other_size(digest->size);
  if (digest->sha256 != file.sha256) return "its SHA-256 is not that of the snapshot";
  return std::nullopt;
}

// Links in a folder of the store and in `levels` of folders below it: commands that write refuse them.
Result<void> find_links(const FileDescriptor& store, const std::filesystem::path& store_path,
                        const std::filesystem::path& relative, int levels, std::vector<Damage>& damage) {
  RAYFIELD_ASSIGN(const FileDescriptor folder, open_folder_below(store, relative, store_path));
  if (!folder.valid()) return {};
  RAYFIELD_ASSIGN(const std::vector<FolderEntry> entries, list_folder(folder, store_path / relative));
  for (const FolderEntry& entry : entries) {
    const std::filesystem::path path = relative / entry.name;
    if (entry.kind == FolderEntry::Kind::link)
      damage.push_back({path.generic_string(), "it is a link where a folder of the store belongs"});
    else if (entry.kind == FolderEntry::Kind::folder && levels > 0)
      RAYFIELD_CHECK(find_links(store, store_path, path, levels - 1, damage));
  }
  return {};
}

// Whatever stands where a folder of the store, or its lock, belongs. Readers would follow a link without a word.
Result<std::vector<Damage>> misplaced(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 5> kFolders = {layout::kSnapshots, layout::kScans, layout::kRegistry,
                                                        layout::kTemporary, layout::kTrash};
  std::vector<Damage> damage;
  RAYFIELD_ASSIGN(const FileDescriptor store, open_store_folder(path));
  RAYFIELD_ASSIGN(const std::vector<FolderEntry> entries, list_folder(store, path));
  for (const FolderEntry& entry : entries) {
    const bool is_folder = std::find(kFolders.begin(), kFolders.end(), entry.name) != kFolders.end();
    if (is_folder && entry.kind != FolderEntry::Kind::folder)
      damage.push_back({entry.name, "it is a link or a file where a folder of the store belongs"});
    if (entry.name == layout::kLock && entry.kind != FolderEntry::Kind::file)
      damage.push_back({entry.name, "it is a link or something else than a file"});
    if (entry.kind != FolderEntry::Kind::folder) continue;
    if (entry.name == layout::kScans) RAYFIELD_CHECK(find_links(store, path, entry.name, 1, damage));
    if (entry.name == layout::kRegistry) RAYFIELD_CHECK(find_links(store, path, entry.name, 0, damage));
  }
  return damage;
}

// Files of the snapshots, each once.
std::vector<FileEntry> files_to_check(const SnapshotChain& chain, bool all) {
  std::map<std::tuple<std::string, std::string, std::uint64_t>, FileEntry> files;
  for (const auto& [number, snapshot] : chain.intact) {
    if (!all && number != chain.intact.rbegin()->first) continue;
    for (const FileEntry* file : snapshot.files()) files[{file->path, file->sha256, file->size}] = *file;
  }
  std::vector<FileEntry> list;
  for (const auto& [key, file] : files) list.push_back(file);
  return list;
}

}  // namespace

Result<std::vector<Damage>> verify_store(const std::filesystem::path& folder, bool all, int threads,
                                         Progress& progress) {
  RAYFIELD_ASSIGN(std::vector<Damage> damage, misplaced(folder));
  if (const auto config = read_sealed_json("store", folder / layout::kStoreFile); !config) {
    if (config.error().code == ErrorCode::resources) return tl::make_unexpected(config.error());
    damage.push_back({layout::kStoreFile, config.error().why});
  }
  RAYFIELD_ASSIGN(const SnapshotChain chain, read_chain(folder));
  damage.insert(damage.end(), chain.damage.begin(), chain.damage.end());
  const std::vector<FileEntry> files = files_to_check(chain, all);
  std::uint64_t bytes = 0;
  for (const FileEntry& file : files) bytes += file.size;
  progress.stage("verifying", bytes, "bytes");
  std::vector<std::optional<std::string>> problems(files.size());
  const auto check = [&](std::size_t i, int) -> Result<void> {
    RAYFIELD_ASSIGN(problems[i], problem_of(folder, files[i], [&] { return progress.cancelled(); }));
    progress.advance(files[i].size);
    return {};
  };
  RAYFIELD_CHECK(parallel_for(files.size(), thread_count(threads), check));
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (problems[i]) damage.push_back({files[i].path, *problems[i]});
  }
  return damage;
}

}  // namespace rayfield::tile
