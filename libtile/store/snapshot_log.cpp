#include "libtile/store/snapshot_log.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <system_error>

#include "libtile/files/durable_writer.h"
#include "libtile/files/fault.h"
#include "libtile/files/file_io.h"
#include "libtile/files/sealed_json.h"
#include "libtile/files/store_layout.h"
#include "libtile/files/writer_lock.h"
#include "libtile/store/snapshot_json.h"

namespace rayfield::tile {
namespace {

constexpr int kAttempts = 16;

Result<void> link_exclusively(const std::filesystem::path& from, const std::filesystem::path& to, bool& taken) {
  taken = false;
  if (const int error = fault::point("link")) return fail_io(error, "cannot publish", to);
  if (::link(from.c_str(), to.c_str()) == 0) return {};
  if (errno == EEXIST) {
    taken = true;
    return {};
  }
  if (errno == EPERM || errno == EOPNOTSUPP)
    return fail(ErrorCode::resources, "cannot publish", to.string(), "the file system has no hard links",
                "keep the store on a file system of Linux");
  return fail_io(errno, "cannot publish", to);
}

}  // namespace

std::filesystem::path snapshot_path(const std::filesystem::path& store, std::uint64_t number) {
  return store / layout::kSnapshots / layout::snapshot_file_name(number);
}

Result<std::vector<std::uint64_t>> snapshot_numbers(const std::filesystem::path& store) {
  const std::filesystem::path folder = store / layout::kSnapshots;
  std::error_code error;
  std::vector<std::uint64_t> numbers;
  std::filesystem::directory_iterator entries(folder, error);
  for (; !error && entries != std::filesystem::directory_iterator(); entries.increment(error)) {
    const std::string name = entries->path().filename().string();
    std::uint64_t number = 0;
    const auto [end, bad] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (bad == std::errc() && number > 0 && name == layout::snapshot_file_name(number)) numbers.push_back(number);
  }
  if (error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory)
    return fail(ErrorCode::damaged, "cannot read the store", folder.string(), error.message(), "run `rayfield verify`");
  if (error) return fail_io(error.value(), "cannot read the store", folder);
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

Result<Snapshot> load_snapshot(const std::filesystem::path& store, std::uint64_t number) {
  const std::filesystem::path path = snapshot_path(store, number);
  RAYFIELD_ASSIGN(const auto json, read_sealed_json("snapshot", path));
  RAYFIELD_ASSIGN(Snapshot snapshot, snapshot_from_json(json, path.string()));
  if (snapshot.number != number)
    return fail(ErrorCode::damaged, "cannot read the store", path.string(), "it holds another snapshot's number",
                "run `rayfield verify`");
  return snapshot;
}

Result<Snapshot> existing_snapshot(const std::filesystem::path& store, std::uint64_t number) {
  RAYFIELD_ASSIGN(const std::vector<std::uint64_t> numbers, snapshot_numbers(store));
  if (std::binary_search(numbers.begin(), numbers.end(), number)) return load_snapshot(store, number);
  const std::string there =
      numbers.empty() ? std::string("the store has none yet")
                      : "the store has " + std::to_string(numbers.front()) + " to " + std::to_string(numbers.back());
  return fail(ErrorCode::usage, "unknown snapshot", std::to_string(number), there, "see `rayfield log`");
}

Result<std::vector<Snapshot>> all_snapshots(const std::filesystem::path& store) {
  RAYFIELD_ASSIGN(const std::vector<std::uint64_t> numbers, snapshot_numbers(store));
  std::vector<Snapshot> snapshots;
  for (const std::uint64_t number : numbers) {
    RAYFIELD_ASSIGN(Snapshot snapshot, load_snapshot(store, number));
    snapshots.push_back(std::move(snapshot));
  }
  return snapshots;
}

// The note is read first: a writer may publish at any time, and notes it afterwards.
Result<Snapshot> latest_snapshot(const std::filesystem::path& store) {
  const std::uint64_t published = last_published(store).value_or(0);
  RAYFIELD_ASSIGN(const std::vector<std::uint64_t> numbers, snapshot_numbers(store));
  const std::uint64_t newest = numbers.empty() ? 0 : numbers.back();
  if (newest < published)
    return fail(ErrorCode::damaged, "cannot read the store", snapshot_path(store, published).string(),
                newest == 0
                    ? fmt::format("snapshot {} was published, and none is there any more", published)
                    : fmt::format("snapshot {} was published, and the newest that is there is {}", published, newest),
                "bring it back from a copy, or run `rayfield repair`");
  if (newest == 0) return Snapshot{};
  return load_snapshot(store, newest);
}

Result<bool> publish_as(const std::filesystem::path& store, const std::string& command, Snapshot& next) {
  next.created_utc = now_utc();
  next.software_version = RAYFIELD_VERSION;
  next.command = command;
  const std::string text = seal_json("snapshot", to_json(next));
  RAYFIELD_ASSIGN(const std::filesystem::path temporary,
                  write_temporary(store / layout::kTemporary, std::as_bytes(std::span(text))));
  bool taken = false;
  const Result<void> linked = link_exclusively(temporary, snapshot_path(store, next.number), taken);
  ::unlink(temporary.c_str());
  RAYFIELD_CHECK(linked);
  if (taken) return false;
  RAYFIELD_CHECK(sync_directory(store / layout::kSnapshots));
  note_published(store, next.number);
  return true;
}

Result<Snapshot> publish(const std::filesystem::path& store, const std::string& command,
                         const std::function<Result<std::optional<Snapshot>>(const Snapshot& latest)>& change) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    RAYFIELD_ASSIGN(const Snapshot latest, latest_snapshot(store));
    RAYFIELD_ASSIGN(std::optional<Snapshot> next, change(latest));
    if (!next) {
      // The run that linked it may have died before it made the name durable.
      RAYFIELD_CHECK(sync_directory(store / layout::kSnapshots));
      note_published(store, latest.number);
      return latest;
    }
    next->number = latest.number + 1;
    next->parent = latest.number;
    next->lost = latest.lost;  // also where the rest is that of an older one
    RAYFIELD_ASSIGN(const bool published, publish_as(store, command, *next));
    if (published) return *next;
  }
  return fail(ErrorCode::locked, "cannot publish", store.string(), "other writers publish all the time",
              "wait until they have finished");
}

}  // namespace rayfield::tile
