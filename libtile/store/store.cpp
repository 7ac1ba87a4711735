#include "rayfield/tile/store.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <set>
#include <system_error>

#include "libtile/files/durable_writer.h"
#include "libtile/files/fault.h"
#include "libtile/files/file_io.h"
#include "libtile/files/sealed_json.h"
#include "libtile/files/store_layout.h"
#include "libtile/files/writer_lock.h"
#include "libtile/hdf5/array_image.h"
#include "libtile/store/add_scan.h"
#include "libtile/store/garbage.h"
#include "libtile/store/open_store.h"
#include "libtile/store/remove_scan.h"
#include "libtile/store/repair.h"
#include "libtile/store/revert.h"
#include "libtile/store/snapshot_json.h"
#include "libtile/store/snapshot_log.h"
#include "libtile/store/verify.h"

namespace rayfield::tile {
namespace {

namespace fs = std::filesystem;

// A folder may become a store when it is empty or when an earlier attempt to make it one was interrupted.
Result<void> check_free(const fs::path& folder) {
  static const std::set<std::string> kOurs = {layout::kLock, layout::kTemporary, layout::kSnapshots, layout::kScans,
                                              layout::kRegistry};
  std::error_code error;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    if (!kOurs.contains(entry->path().filename().string()))
      return fail(ErrorCode::usage, "cannot create a store", folder.string(),
                  "the folder holds other things ('" + entry->path().filename().string() + "')",
                  "give an empty or a new folder");
  }
  if (error) return fail_io(error.value(), "cannot create a store", folder);
  if (!fs::exists(folder / layout::kSnapshots, error)) return {};
  RAYFIELD_ASSIGN(const auto numbers, snapshot_numbers(folder));
  if (!numbers.empty())
    return fail(ErrorCode::damaged, "cannot create a store", folder.string(), "it holds snapshots but no store.json");
  return {};
}

Result<StoreConfig> read_config(const fs::path& folder) {
  const fs::path path = folder / layout::kStoreFile;
  RAYFIELD_ASSIGN(const auto json, read_sealed_json("store", path));
  return config_from_json(json, path.string());
}

bool same(const StoreConfig& a, const StoreConfig& b) {
  return a.crs == b.crs && a.tile_size_m == b.tile_size_m && a.tile_margin_m == b.tile_margin_m;
}

Result<void> write_config(const fs::path& folder, const StoreConfig& config) {
  const std::string text = seal_json("store", to_json(config));
  RAYFIELD_ASSIGN(const fs::path temporary,
                  write_temporary(folder / layout::kTemporary, std::as_bytes(std::span(text))));
  int error = fault::point("link");
  if (error == 0 && ::link(temporary.c_str(), (folder / layout::kStoreFile).c_str()) != 0) error = errno;
  ::unlink(temporary.c_str());
  if (error == EPERM || error == EOPNOTSUPP)
    return fail(ErrorCode::resources, "cannot create a store", folder.string(), "the file system has no hard links",
                "keep the store on a file system of Linux");
  if (error != 0) return fail_io(error, "cannot create a store", folder);
  RAYFIELD_CHECK(sync_directory(folder));
  note_published(folder, 0);
  return {};
}

}  // namespace

// Making a store that is there already, with the same settings, is not an error: a run that was interrupted after
// store.json was linked is repeated with success.
Result<Store> Store::create(const fs::path& folder, const StoreConfig& config) {
  RAYFIELD_CHECK(config.validate());
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    return fail(ErrorCode::usage, "cannot create a store", folder.string(), "it is not a folder",
                "give an empty or a new folder");
  fs::create_directories(folder, error);
  if (error) return fail_output(error.value(), "cannot create a store", folder.string());
  if (!fs::exists(folder / layout::kStoreFile, error)) RAYFIELD_CHECK(check_free(folder));
  RAYFIELD_ASSIGN(const WriterLock lock, WriterLock::take(folder));
  for (const char* part : {layout::kSnapshots, layout::kScans, layout::kRegistry})
    RAYFIELD_CHECK(make_directories(folder, part));
  if (fs::exists(folder / layout::kStoreFile, error)) {
    RAYFIELD_ASSIGN(const Store store, open(folder));
    if (same(store.config(), config)) {
      RAYFIELD_CHECK(sync_directory(folder));
      return store;
    }
    return fail(
        ErrorCode::usage, "cannot create a store", folder.string(),
        fmt::format("it is a store already, with {} and {} m tiles", store.config().crs, store.config().tile_size_m),
        "give another folder");
  }
  RAYFIELD_CHECK(write_config(folder, config));
  if (const fs::path parent = fs::absolute(folder, error).parent_path(); !error && ::access(parent.c_str(), W_OK) == 0)
    RAYFIELD_CHECK(sync_directory(parent));
  return open(folder);
}

Result<Store> Store::open(const fs::path& folder) {
  std::error_code error;
  const bool is_folder = fs::is_directory(folder, error);
  if (error && error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory)
    return fail_errno(error.value(), "cannot open the store", folder.string());
  if (!is_folder)
    return fail(ErrorCode::bad_input, "cannot open the store", folder.string(), "there is no such folder",
                "create it with `rayfield init`");
  const bool has_config = fs::exists(folder / layout::kStoreFile, error);
  if (error) return fail_errno(error.value(), "cannot open the store", folder.string());
  if (!has_config)
    return fail(ErrorCode::bad_input, "cannot open the store", folder.string(),
                "it is not a rayfield store (no store.json)", "create one with `rayfield init`");
  RAYFIELD_ASSIGN(StoreConfig config, read_config(folder));
  RAYFIELD_CHECK(config.validate());
  return Store(std::make_shared<const OpenStore>(folder, std::move(config)));
}

const StoreConfig& Store::config() const { return store_->config; }
const fs::path& Store::folder() const { return store_->folder; }

std::string Store::block_name() const {
  fs::path path = fs::weakly_canonical(store_->folder);
  if (path.filename().empty()) path = path.parent_path();
  return path.filename().string();
}

Result<Snapshot> Store::latest() const { return latest_snapshot(store_->folder); }
Result<std::vector<Snapshot>> Store::history() const { return all_snapshots(store_->folder); }

Result<Snapshot> Store::snapshot(std::uint64_t number) const { return existing_snapshot(store_->folder, number); }

Result<AddReport> Store::add(RaySource& rays, const AddOptions& options, Progress& progress) {
  return add_scan(*store_, rays, options, progress);
}
Result<std::optional<AddReport>> Store::find_added(const AddOptions& options) const {
  return find_added_scan(store_->folder, options);
}

Result<RemoveReport> Store::remove(const std::string& scan, const std::string& command) {
  return remove_scan(store_->folder, scan, command);
}
Result<std::string> Store::find_scan_to_remove(const std::string& scan) const {
  return find_scan_to_remove_in(store_->folder, scan);
}
Result<RevertReport> Store::revert(std::uint64_t number, const std::string& command) {
  return revert_store(store_->folder, number, command);
}

Result<void> Store::set_dormant(const std::string& scan_id, std::optional<bool> dormant, const std::string& command) {
  RAYFIELD_ASSIGN(const WriterLock lock, WriterLock::take(folder()));
  const auto changed = [&](Snapshot snapshot) -> Result<std::optional<Snapshot>> {
    for (ScanEntry& scan : snapshot.scans) {
      if (scan.scan_id != scan_id) continue;
      if (scan.dormant == dormant) return std::nullopt;
      scan.dormant = dormant;
      return snapshot;
    }
    return fail(ErrorCode::usage, "unknown scan", scan_id, "the store has no scan of that id", "see `rayfield status`");
  };
  RAYFIELD_CHECK(publish(folder(), command, changed));
  return {};
}

Result<TileReader> Store::open_tile(const TileEntry& tile) const { return TileReader::open(*store_, tile); }

Result<ArraySet> Store::read_derived(const DerivedEntry& entry) const {
  const fs::path path = store_->folder / entry.file.path;
  RAYFIELD_ASSIGN(const std::vector<std::byte> bytes, store_->files.read(entry.file));
  RAYFIELD_ASSIGN(ArraySet arrays, decode_arrays(bytes, path.string()));
  if (arrays.kind != entry.kind) return file_damaged(path, "it holds '" + arrays.kind + "', not '" + entry.kind + "'");
  return arrays;
}

Result<ArrayReader> Store::open_derived(const DerivedEntry& entry) const { return ArrayReader::open(*store_, entry); }

Result<std::string> Store::read_attachment(const AttachmentEntry& entry) const {
  RAYFIELD_ASSIGN(const std::vector<std::byte> bytes, store_->files.read(entry.file));
  return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

Result<DerivedWriter> Store::write_derived() { return DerivedWriter::open(store_); }

Result<std::vector<Damage>> Store::verify(bool all, int threads, Progress& progress) const {
  return verify_store(store_->folder, all, threads, progress);
}
Result<GarbageReport> Store::gc(const GarbageOptions& options) { return collect_garbage(store_->folder, options); }

Result<RepairReport> Store::repair(bool dry_run, const std::string& command, Progress& progress) {
  return repair_store(*this, dry_run, command, progress);
}

}  // namespace rayfield::tile
