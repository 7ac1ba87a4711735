#include "tests/fault/damage_campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>

#include "libtile/files/store_layout.h"
#include "libtile/store/snapshot_json.h"

namespace rayfield::tile::testing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFilesAtOnce = 12;  // one verify() for all of them

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// A new file, as those of a store cannot be written to.
void put(const fs::path& path, const std::string& bytes) {
  fs::remove(path);
  fs::create_directories(path.parent_path());
  std::ofstream out(path, std::ios::binary);
  if (!out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush())
    throw std::runtime_error("cannot write " + path.string());
}

void put(const fs::path& path, const DamagedFile& file) {
  if (file.gone) {
    fs::remove(path);
  } else {
    put(path, file.bytes);
  }
}

std::string kind_of(const fs::path& path) {
  std::vector<std::string> parts;
  for (const auto& part : path) parts.push_back(part.string());
  return parts.front() == layout::kScans ? parts.at(2) : parts.front();
}

std::vector<Damage> damage_of(const Store& store) {
  Progress progress;
  auto damage = store.verify(true, 1, progress);
  if (!damage) return {{"", damage.error().line()}};
  return *damage;
}

bool names(const std::vector<Damage>& damage, const std::string& path) {
  return std::any_of(damage.begin(), damage.end(), [&](const Damage& d) { return d.path == path; });
}

// An error of a damaged file has its code, its name, and a reason.
void expect_damaged(const Error& error, const std::string& path, const std::string& what, DamageTally& tally) {
  if (error.code != ErrorCode::damaged)
    tally.findings.push_back(fmt::format("wrong: {}: code {}: {}", what, static_cast<int>(error.code), error.line()));
  else if (error.why.empty() || error.line().find(path) == std::string::npos)
    tally.findings.push_back(fmt::format("unclear: {}: {}", what, error.line()));
}

}  // namespace

DamageCampaign::DamageCampaign(const fs::path& store, const fs::path& spare) : store_(store), spare_(spare) {
  for (const auto& entry : fs::recursive_directory_iterator(store)) {
    if (!entry.is_regular_file()) continue;
    const std::string path = entry.path().lexically_relative(store).generic_string();
    files_[path] = text_of(entry.path());
    if (path.starts_with(layout::kScans) || path.starts_with(layout::kRegistry)) continue;
    history_.push_back(path);
    put(spare / path, files_[path]);
  }
  std::sort(history_.begin(), history_.end());
  const Store opened = Store::open(store).value();
  const std::vector<Snapshot> history = opened.history().value();
  for (const Snapshot& snapshot : history) take_entries(snapshot);
  for (const auto& [path, entry] : entries_) kinds_[kind_of(path)].push_back(path);
  latest_ = to_json(opened.latest().value()).dump();
}

DamageCampaign::~DamageCampaign() {
  std::error_code ignored;
  fs::remove_all(spare_, ignored);
}

void DamageCampaign::take_entries(const Snapshot& snapshot) {
  numbers_[fmt::format("{}/{}", layout::kSnapshots, layout::snapshot_file_name(snapshot.number))] = snapshot.number;
  for (const DerivedEntry& derived : snapshot.registry) entries_[derived.file.path] = derived;
  for (const ScanEntry& scan : snapshot.scans) {
    for (const DerivedEntry& derived : scan.derived) entries_[derived.file.path] = derived;
    for (const AttachmentEntry& attachment : scan.attachments) entries_[attachment.file.path] = attachment;
    for (const TileEntry& tile : scan.tiles) {
      entries_[tile.file.path] = tile;
      for (const FileEntry& more : tile.more_files) entries_[more.path] = tile;
    }
  }
}

void DamageCampaign::restore() const {
  for (const auto& [path, bytes] : files_) {
    if (text_of(store_ / path) != bytes || !fs::exists(store_ / path)) put(store_ / path, bytes);
  }
  for (const std::string& path : history_) put(spare_ / path, files_.at(path));
}

std::vector<DamageCampaign::Hurt> DamageCampaign::hurt_some(std::size_t first_kind, std::mt19937_64& random) const {
  std::vector<Hurt> hurt;
  std::set<std::string> taken;
  for (std::size_t i = 0; i < kFilesAtOnce; ++i) {
    const auto& paths =
        std::next(kinds_.begin(), static_cast<std::ptrdiff_t>((first_kind + i) % kinds_.size()))->second;
    const std::string &path = paths[random() % paths.size()], &other = paths[random() % paths.size()];
    if (!taken.insert(path).second) continue;
    const DamagedFile file = damaged(files_.at(path), files_.at(other), random);
    put(store_ / path, file);
    hurt.push_back({path, path + ": " + file.how});
  }
  return hurt;
}

void DamageCampaign::read_hurt(const Store& store, const Hurt& hurt, DamageTally& tally) const {
  const auto expect_refused = [&](const auto& result, const char* how) {
    if (result)
      tally.findings.push_back(fmt::format("wrong: {}: {} gives something", hurt.what, how));
    else
      expect_damaged(result.error(), hurt.path, fmt::format("{}: {}", hurt.what, how), tally);
  };
  const Entry& entry = entries_.at(hurt.path);
  if (const auto* tile = std::get_if<TileEntry>(&entry)) {
    expect_refused(store.open_tile(*tile), "open_tile");
  } else if (const auto* derived = std::get_if<DerivedEntry>(&entry)) {
    expect_refused(store.read_derived(*derived), "read_derived");
    expect_refused(store.open_derived(*derived), "open_derived");
  } else {
    expect_refused(store.read_attachment(std::get<AttachmentEntry>(entry)), "read_attachment");
  }
}

void DamageCampaign::use_data(const std::vector<Hurt>& hurt, DamageTally& tally) const {
  const auto store = Store::open(store_);
  if (!store) return tally.findings.push_back("wrong: the store does not open: " + store.error().line());
  const std::vector<Damage> damage = damage_of(*store);
  for (const Hurt& file : hurt) {
    if (!names(damage, file.path)) tally.findings.push_back("wrong: verify finds nothing: " + file.what);
    read_hurt(*store, file, tally);
  }
  if (damage.size() > hurt.size())
    tally.findings.push_back(fmt::format("wrong: verify names {} files of {}", damage.size(), hurt.size()));
}

// Whoever asks for the newest state gets it as it was, or an error.
void DamageCampaign::use_snapshots(const Store& store, const std::string& path, const DamagedFile& file,
                                   DamageTally& tally) const {
  const std::string what = path + ": " + file.how;
  const auto latest = store.latest();
  if (latest && to_json(*latest).dump() != latest_) tally.findings.push_back("wrong: another newest state: " + what);
  if (!latest && latest.error().code != ErrorCode::damaged)
    tally.findings.push_back("wrong: no damage but: " + latest.error().line() + ": " + what);
  const auto number = numbers_.find(path);
  if (number == numbers_.end()) return;
  if (latest && number->second == numbers_.rbegin()->second)
    tally.findings.push_back("wrong: the newest state without its snapshot: " + what);
  if (!names(damage_of(store), path)) tally.findings.push_back("wrong: verify finds nothing: " + what);
  if (const auto one = store.snapshot(number->second); one)
    tally.findings.push_back("wrong: snapshot() gives something: " + what);
  else if (!file.gone)
    expect_damaged(one.error(), path, what, tally);
}

void DamageCampaign::use_history(const std::string& path, const DamagedFile& file, DamageTally& tally) const {
  const auto store = Store::open(spare_);
  if (path == layout::kStoreFile) {
    if (store)
      tally.findings.push_back("wrong: the store opens: " + path + ": " + file.how);
    else if (!file.gone)  // then it is no store
      expect_damaged(store.error(), path, path + ": " + file.how, tally);
  } else if (!store) {
    tally.findings.push_back("wrong: the store does not open: " + store.error().line());
  } else {
    use_snapshots(*store, path, file, tally);
  }
}

DamageTally DamageCampaign::run(std::size_t damages, std::uint64_t seed,
                                const std::function<void(const std::string&)>& announce) const {
  DamageTally tally;
  std::mt19937_64 random(seed);
  std::size_t done = 0;
  for (std::size_t round = 0; done < damages; ++round) {
    const std::vector<Hurt> hurt = hurt_some(round * kFilesAtOnce, random);
    std::string all;
    for (const Hurt& file : hurt) all += file.what + "; ", ++tally.damages[kind_of(file.path)];
    announce(all);
    use_data(hurt, tally);
    for (const Hurt& file : hurt) put(store_ / file.path, files_.at(file.path));
    done += hurt.size();
    for (int i = 0; i < 3; ++i, ++done) {
      const std::string &path = history_[random() % history_.size()], &other = history_[random() % history_.size()];
      const DamagedFile file = damaged(files_.at(path), files_.at(other), random);
      put(spare_ / path, file);
      ++tally.damages[kind_of(path)];
      announce(path + ": " + file.how);
      use_history(path, file, tally);
      put(spare_ / path, files_.at(path));
    }
  }
  return tally;
}

}  // namespace rayfield::tile::testing
