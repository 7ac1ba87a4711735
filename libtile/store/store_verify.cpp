#include <algorithm>
#include <map>
#include <tuple>

#include "libtile/files/file_io.h"
#include "libtile/files/sealed_json.h"
#include "libtile/files/store_layout.h"
#include "libtile/store/snapshot_json.h"
#include "libtile/store/snapshot_log.h"
#include "libtile/store/store_files.h"
#include "libtile/store/store_impl.h"
#include "rayfield/core/parallel.h"
#include "rayfield/tile/store.h"

namespace rayfield::tile {
namespace {

// nullopt: the file is as the entry says.
std::optional<std::string> problem_of(const std::filesystem::path& store, const FileEntry& file) {
  const auto digest = digest_file(store / file.path, "cannot read");
  if (!digest) return digest.error().why == "No such file or directory" ? "the file is missing" : digest.error().why;
  if (digest->size != file.size)
    return "it has " + std::to_string(digest->size) + " bytes instead of " + std::to_string(file.size);
  if (digest->sha256 != file.sha256) return "its SHA-256 is not that of the snapshot";
  return std::nullopt;
}

}  // namespace

Result<std::vector<Damage>> Store::verify(bool all, int threads, Progress& progress) const {
  const std::filesystem::path& folder = impl_->folder;
  std::vector<Damage> damage;
  if (const auto config = read_sealed_json("store", folder / layout::kStoreFile); !config)
    damage.push_back({layout::kStoreFile, config.error().why});
  RAYFIELD_ASSIGN(std::vector<std::uint64_t> numbers, snapshot_numbers(folder));
  if (!all && numbers.size() > 1) numbers.erase(numbers.begin(), numbers.end() - 1);
  std::map<std::tuple<std::string, std::string, std::uint64_t>, FileEntry> files;
  for (const std::uint64_t number : numbers) {
    const auto snapshot = load_snapshot(folder, number);
    if (!snapshot) {
      damage.push_back(
          {std::string(layout::kSnapshots) + "/" + layout::snapshot_file_name(number), snapshot.error().why});
      continue;
    }
    for (const FileEntry* file : files_of(*snapshot)) files[{file->path, file->sha256, file->size}] = *file;
  }
  std::vector<FileEntry> list;
  std::uint64_t bytes = 0;
  for (const auto& [key, file] : files) {
    list.push_back(file);
    bytes += file.size;
  }
  progress.stage("verifying", bytes, "bytes");
  std::vector<std::optional<std::string>> problems(list.size());
  const auto check = [&](std::size_t i, int) -> Result<void> {
    if (progress.cancelled())
      return fail(ErrorCode::interrupted, "interrupted", folder.string(), "not all files were checked");
    problems[i] = problem_of(folder, list[i]);
    progress.advance(list[i].size);
    return {};
  };
  RAYFIELD_CHECK(parallel_for(list.size(), thread_count(threads), check));
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (problems[i]) damage.push_back({list[i].path, *problems[i]});
  }
  return damage;
}

}  // namespace rayfield::tile
