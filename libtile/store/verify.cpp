#include "libtile/store/verify.h"

#include <cstring>
#include <map>
#include <optional>
#include <system_error>
#include <tuple>

#include "libtile/files/sealed_json.h"
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
  std::vector<Damage> damage;
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
