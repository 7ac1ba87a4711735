#include "libtile/store/revert.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <system_error>

#include "libtile/files/writer_lock.h"
#include "libtile/store/snapshot_json.h"
#include "libtile/store/snapshot_log.h"

namespace rayfield::tile {
namespace {

constexpr std::size_t kMostNamed = 5;

// Files that are not there, or not as long as they were: content is what verify() looks at.
Result<void> check_files(const std::filesystem::path& store, const Snapshot& snapshot) {
  std::vector<std::string> gone;
  for (const FileEntry* file : snapshot.files()) {
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(store / file->path, error);
    if (error && error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory)
      return fail_errno(error.value(), "cannot revert the store", (store / file->path).string());
    if (error || size != file->size) gone.push_back(file->path);
  }
  if (gone.empty()) return {};
  std::string named =
      fmt::format("{}", fmt::join(gone.begin(), gone.begin() + std::min(gone.size(), kMostNamed), ", "));
  if (gone.size() > kMostNamed) named += fmt::format(" and {} more", gone.size() - kMostNamed);
  return fail(ErrorCode::damaged, "cannot revert the store", fmt::format("snapshot {}", snapshot.number),
              fmt::format("{} of its files {} gone: {}", gone.size(), gone.size() == 1 ? "is" : "are", named),
              "choose another snapshot, or bring the files back");
}

bool same_content(const Snapshot& a, const Snapshot& b) {
  const auto ja = to_json(a), jb = to_json(b);
  return ja.at("scans") == jb.at("scans") && ja.at("registry") == jb.at("registry");
}

}  // namespace

Result<RevertReport> revert_store(const std::filesystem::path& store, std::uint64_t number,
                                  const std::string& command) {
  RAYFIELD_ASSIGN(const WriterLock lock, WriterLock::take(store));
  RAYFIELD_ASSIGN(const Snapshot old, existing_snapshot(store, number));
  RAYFIELD_CHECK(check_files(store, old));
  RevertReport report;
  RAYFIELD_ASSIGN(const Snapshot published,
                  publish(store, command, [&](const Snapshot& latest) -> Result<std::optional<Snapshot>> {
                    report.already_there = same_content(latest, old);
                    if (report.already_there) return std::nullopt;
                    return old;
                  }));
  report.snapshot = published.number;
  for (const ScanEntry& scan : published.scans) report.scans.push_back(scan.scan_id);
  return report;
}

}  // namespace rayfield::tile
