#include "rayfield/tile/derived_writer.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <system_error>
#include <tuple>

#include "libtile/files/durable_writer.h"
#include "libtile/files/file_io.h"
#include "libtile/files/store_layout.h"
#include "libtile/files/writer_lock.h"
#include "libtile/hdf5/array_image.h"
#include "libtile/hdf5/seal.h"
#include "libtile/store/open_store.h"
#include "libtile/store/snapshot_log.h"
#include "rayfield/core/sha256.h"

namespace rayfield::tile {
namespace {

namespace fs = std::filesystem;

bool before(const DerivedEntry& a, const DerivedEntry& b) {
  return std::tie(a.kind, a.name) < std::tie(b.kind, b.name);
}

bool same(const DerivedEntry& a, const DerivedEntry& b) {
  return a.kind == b.kind && a.name == b.name && a.key == b.key && a.file.path == b.file.path &&
         a.file.size == b.file.size && a.file.sha256 == b.file.sha256;
}

bool same(const std::vector<DerivedEntry>& a, const std::vector<DerivedEntry>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const DerivedEntry& x, const DerivedEntry& y) { return same(x, y); });
}

Result<void> check_names(const NewDerived& what) {
  const bool good = (what.scan_id.empty() || layout::is_plain_name(what.scan_id)) && layout::is_plain_name(what.kind) &&
                    layout::is_plain_name(what.name) && layout::is_plain_name(what.key) && what.key.size() >= 16 &&
                    !((what.kind == layout::kRays || what.kind == layout::kAttachments) && !what.scan_id.empty());
  if (good) return {};
  return fail(ErrorCode::internal, "cannot store derived data", what.kind + "/" + what.name,
              "kind, name and key must be plain names and the key a digest");
}

}  // namespace

struct DerivedWriter::Impl {
  Impl(std::shared_ptr<const OpenStore> owner, WriterLock writer_lock, Snapshot snapshot)
      : store(std::move(owner)), lock(std::move(writer_lock)), base(std::move(snapshot)), writer(store->folder) {}

  std::shared_ptr<const OpenStore> store;
  WriterLock lock;
  Snapshot base;
  DurableWriter writer;
  std::mutex mutex;
  std::map<std::string, std::vector<DerivedEntry>> staged;
  std::map<std::string, std::vector<std::string>> listings;  // file names of a directory as this writer found it

  const std::vector<DerivedEntry>* published(const std::string& scan_id) const {
    if (scan_id.empty()) return &base.registry;
    const ScanEntry* scan = base.find_scan(scan_id);
    return scan == nullptr ? nullptr : &scan->derived;
  }

  std::vector<std::string> listing(const std::string& directory) {
    const std::lock_guard guard(mutex);
    const auto [it, is_new] = listings.try_emplace(directory);
    if (is_new) {
      std::error_code error;
      for (fs::directory_iterator e(store->folder / directory, error); !error && e != fs::directory_iterator();
           e.increment(error))
        it->second.push_back(e->path().filename().string());
      std::sort(it->second.begin(), it->second.end());
    }
    return it->second;
  }

  // A file that an interrupted run has left: its seal says whether it is whole.
  std::optional<DerivedEntry> find_unpublished(const NewDerived& what) {
    const std::string directory = layout::derived_directory(what.scan_id, what.kind);
    const std::string prefix = layout::derived_prefix(what.name, what.key);
    for (const std::string& name : listing(directory)) {
      if (name.compare(0, prefix.size(), prefix) != 0) continue;
      const fs::path path = store->folder / directory / name;
      const auto bytes = read_file(path, "cannot read file of the store");
      if (!bytes || !is_sealed(*bytes)) continue;
      const std::string sha256 = sha256_hex(*bytes);
      if (name != layout::derived_file_name(what.name, what.key, sha256)) continue;
      writer.touch(directory);
      return DerivedEntry{
          what.kind, what.name, what.key, {fmt::format("{}/{}", directory, name), bytes->size(), sha256}};
    }
    return std::nullopt;
  }
};

Result<DerivedWriter> DerivedWriter::open(std::shared_ptr<const OpenStore> store) {
  RAYFIELD_ASSIGN(WriterLock lock, WriterLock::take(store->folder));
  RAYFIELD_ASSIGN(Snapshot snapshot, latest_snapshot(store->folder));
  DerivedWriter writer;
  writer.impl_ = std::make_shared<Impl>(std::move(store), std::move(lock), std::move(snapshot));
  return writer;
}

std::optional<DerivedEntry> DerivedWriter::find(const NewDerived& what) const {
  if (!check_names(what)) return std::nullopt;
  if (const std::vector<DerivedEntry>* entries = impl_->published(what.scan_id)) {
    for (const DerivedEntry& entry : *entries) {
      if (entry.kind == what.kind && entry.name == what.name && entry.key == what.key &&
          impl_->store->files.check(entry.file))
        return entry;
    }
  }
  return impl_->find_unpublished(what);
}

Result<DerivedEntry> DerivedWriter::put(const NewDerived& what, const ArraySet& arrays) {
  return put_columns(what, arrays, {});
}

Result<DerivedEntry> DerivedWriter::put(const NewDerived& what, const StreamedArrays& arrays) {
  return put_columns(what, arrays.arrays, arrays.streamed);
}

Result<DerivedEntry> DerivedWriter::put_columns(const NewDerived& what, const ArraySet& arrays,
                                                const std::map<std::string, ColumnSource>& streamed) {
  RAYFIELD_CHECK(check_names(what));
  if (arrays.kind != what.kind)
    return fail(ErrorCode::internal, "cannot store derived data", what.kind + "/" + what.name,
                "the arrays say that they are '" + arrays.kind + "'");
  if (auto found = find(what)) return *found;
  RAYFIELD_ASSIGN(const std::vector<std::byte> bytes, encode_arrays(arrays, streamed));
  RAYFIELD_ASSIGN(FileEntry file, impl_->writer.write(bytes, layout::derived_directory(what.scan_id, what.kind),
                                                      [&](const std::string& sha256) {
                                                        return layout::derived_file_name(what.name, what.key, sha256);
                                                      }));
  return DerivedEntry{what.kind, what.name, what.key, std::move(file)};
}

fs::path DerivedWriter::scratch_folder() const { return impl_->store->folder / layout::kTemporary; }

Result<void> DerivedWriter::set(const std::string& scan_id, std::vector<DerivedEntry> keep) {
  if (impl_->published(scan_id) == nullptr)
    return fail(ErrorCode::usage, "cannot store derived data", impl_->store->folder.string(),
                "the store holds no scan '" + scan_id + "'");
  std::sort(keep.begin(), keep.end(), before);
  for (std::size_t i = 0; i < keep.size(); ++i) {
    std::error_code error;
    if (fs::file_size(impl_->store->folder / keep[i].file.path, error) != keep[i].file.size || error)
      return fail(ErrorCode::internal, "cannot store derived data", keep[i].file.path, "the file has not been written");
    if (i > 0 && !before(keep[i - 1], keep[i]))
      return fail(ErrorCode::internal, "cannot store derived data", keep[i].kind + "/" + keep[i].name,
                  "it is named twice");
  }
  const std::lock_guard guard(impl_->mutex);
  impl_->staged[scan_id] = std::move(keep);
  return {};
}

Result<Snapshot> DerivedWriter::commit(const std::string& command) {
  RAYFIELD_CHECK(impl_->writer.sync_directories());
  const std::lock_guard guard(impl_->mutex);
  const auto change = [&](const Snapshot& latest) -> Result<std::optional<Snapshot>> {
    Snapshot next = latest;
    bool changed = false;
    for (const auto& [scan_id, keep] : impl_->staged) {
      std::vector<DerivedEntry>* target = scan_id.empty() ? &next.registry : nullptr;
      for (ScanEntry& scan : next.scans) {
        if (!scan_id.empty() && scan.scan_id == scan_id) target = &scan.derived;
      }
      if (target == nullptr)
        return fail(ErrorCode::locked, "cannot publish derived data", impl_->store->folder.string(),
                    "another writer removed scan '" + scan_id + "'", "run the same command again");
      changed = changed || !same(*target, keep);
      *target = keep;
    }
    if (!changed) return std::nullopt;
    return next;
  };
  RAYFIELD_ASSIGN(impl_->base, publish(impl_->store->folder, command, change));
  impl_->staged.clear();
  return impl_->base;
}

}  // namespace rayfield::tile
