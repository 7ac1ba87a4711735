#include "libdensity/learning/block_registry.h"

#include <algorithm>
#include <tuple>

#include "libdensity/learning/first_layout.h"
#include "libdensity/learning/scan_evidence_stage.h"
#include "libdensity/registry/identity.h"
#include "libdensity/registry/layout_arrays.h"
#include "libdensity/scan/stage_versions.h"
#include "rayfield/density/load.h"

namespace rayfield::density {
namespace {

constexpr int kFoundVersion = 2, kRowsVersion = 1;

// The registry's own order: evidence counts by date, and by name where dates are the same.
bool before(const DatedEvidence& a, const DatedEvidence& b) {
  return std::tie(a.date, a.scan_id) < std::tie(b.date, b.scan_id);
}

void name_sources(RowLayout& layout, const std::string& scan_id) {
  const std::string source = "found in " + scan_id;
  const auto name = [&](auto& things) {
    for (auto& thing : things)
      if (thing.identity.source.empty()) thing.identity.source = source;
  };
  name(layout.rows), name(layout.panels), name(layout.posts);
}

}  // namespace

std::string geometry_key(const RowLayout& layout) {
  KeyBuilder key("geometry", kGeometryVersion);
  key.add(layout.spacing_m);
  for (const Row& row : layout.rows) {
    key.add(static_cast<std::int64_t>(row.number)).add(static_cast<std::int64_t>(row.centreline.size()));
    for (const Eigen::Vector2d& p : row.centreline) key.add(p.x()).add(p.y());
    key.add(static_cast<std::int64_t>(row.seen_from_left)).add(static_cast<std::int64_t>(row.seen_from_right));
  }
  for (const Panel& panel : layout.panels)
    key.add({static_cast<double>(panel.row), static_cast<double>(panel.number), panel.start_m, panel.end_m});
  for (const Post& post : layout.posts)
    if (post.detected)
      key.add({static_cast<double>(post.row), post.position.x(), post.position.y(), post.height_m, post.radius_m,
               post.lean.x(), post.lean.y()});
  for (const Trunk& trunk : layout.trunks)
    key.add({static_cast<double>(trunk.row), trunk.position.x(), trunk.position.y(), trunk.radius_m, trunk.top_m});
  return key.hex();
}

Result<BlockRegistry> BlockRegistry::open(const tile::Store& store, const tile::Snapshot& snapshot,
                                          const ProcessOptions& options) {
  BlockRegistry registry(store, options);
  RAYFIELD_ASSIGN(registry.survey_, read_unnamed(store, snapshot, kSurveyKind));
  RAYFIELD_ASSIGN(registry.published_, read_unnamed(store, snapshot, kRowsKind));
  for (const tile::DerivedEntry& entry : snapshot.registry)
    if (entry.kind == kSurveyKind || entry.kind == kNamesKind) registry.kept_.push_back(entry);
  registry.name_ = layout_name(options, registry.survey_.key);
  RAYFIELD_ASSIGN(const std::vector<std::string> scans, select_scans(snapshot, options.dates));
  if (options.redo && scans.size() == snapshot.scans.size()) return registry;
  RAYFIELD_ASSIGN(registry.found_, read_found(store, snapshot, registry.name_));
  if (!registry.found_.known) return registry;
  for (const char* kind : {kFoundKind, kRowsKind})
    if (const tile::DerivedEntry* entry = find_entry(snapshot.registry, kind, registry.name_)) {
      registry.own_.push_back(*entry);
      break;
    }
  for (const tile::ScanEntry& scan : snapshot.scans) {
    const tile::DerivedEntry* entry = find_entry(scan.derived, "stems", "block");
    if (entry == nullptr) continue;
    RAYFIELD_ASSIGN(const tile::ArraySet arrays, store.read_derived(*entry));
    RAYFIELD_ASSIGN(ScanEvidence evidence, evidence_from_arrays(arrays));
    registry.evidence_.push_back({scan.scan_id, scan.date, std::move(evidence)});
    registry.shas_[scan.scan_id] = entry->file.sha256;
  }
  std::sort(registry.evidence_.begin(), registry.evidence_.end(), before);
  return registry;
}

Result<void> BlockRegistry::adopt(ScanWork& work, const SurveyedScan& surveyed, tile::Store::DerivedWriter& writer) {
  KeyBuilder key("found", kFoundVersion);
  key.add(name_).add(published_.key);
  for (const tile::TileEntry& entry : work.scan.tiles) key.add(entry.content_sha256());
  Derivation files(work.store, writer, "", work.options.redo);
  const auto make = [&]() -> Result<tile::ArraySet> {
    Result<FoundLayout> found =
        survey_.known ? complete_survey(work, surveyed, survey_.layout) : find_layout(work, surveyed);
    if (!found) return tl::make_unexpected(std::move(found).error());
    notes_ = std::move(found->notes);
    name_sources(found->layout, work.scan.scan_id);
    take_over_identities(published_.layout, found->layout);
    name_by_place(found->layout, work.store.config().crs);
    return layout_to_arrays(found->layout, kFoundKind);
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, files.get(kFoundKind, name_, key.hex(), make));
  RAYFIELD_ASSIGN(found_.layout, layout_from_arrays(arrays));
  own_ = {files.entry(kFoundKind, name_)};
  found_.key = own_.front().file.sha256;
  found_.known = true;
  learner_.reset();
  return {};
}

// Scans are processed in the order of their evidence, so that each is learned from once.
const RowLayout& BlockRegistry::learned_from(std::size_t count) {
  if (!learner_ || taken_ > count) {
    learner_.emplace(found_.layout, options_.registry, options_.rows, store_.config().crs);
    taken_ = 0;
  }
  for (; taken_ < count; ++taken_) learner_->take(evidence_[taken_]);
  return learner_->layout();
}

bool BlockRegistry::has_evidence_of(const tile::ScanEntry& scan) const { return shas_.count(scan.scan_id) > 0; }

RowLayout BlockRegistry::known_before(const tile::ScanEntry& scan) {
  const auto place =
      std::lower_bound(evidence_.begin(), evidence_.end(), DatedEvidence{scan.scan_id, scan.date, {}}, before);
  return layout_on(learned_from(static_cast<std::size_t>(place - evidence_.begin())), scan.date);
}

Result<void> BlockRegistry::take_evidence(ScanWork& work, const SurveyedScan& surveyed) {
  DatedEvidence dated{work.scan.scan_id, work.scan.date, {}};
  RAYFIELD_ASSIGN(dated.evidence, gather_evidence(work, surveyed, known_before(work.scan)));
  const auto place = std::lower_bound(evidence_.begin(), evidence_.end(), dated, before);
  if (place != evidence_.end() && place->scan_id == dated.scan_id) {
    *place = std::move(dated);
  } else {
    evidence_.insert(place, std::move(dated));
  }
  shas_[work.scan.scan_id] = work.files.sha256("stems", "block");
  return {};
}

void BlockRegistry::forget(const std::string& scan_id) {
  std::erase_if(evidence_, [&](const DatedEvidence& dated) { return dated.scan_id == scan_id; });
  shas_.erase(scan_id);
  learner_.reset();
}

RowLayout BlockRegistry::layout_for(const tile::ScanEntry& scan) {
  const auto last = std::find_if(evidence_.begin(), evidence_.end(),
                                 [&](const DatedEvidence& e) { return e.scan_id == scan.scan_id; });
  const std::size_t count = static_cast<std::size_t>(last - evidence_.begin()) + (last == evidence_.end() ? 0 : 1);
  return layout_on(learned_from(count), scan.date);
}

Result<RowLayout> BlockRegistry::finish(tile::Store::DerivedWriter& writer) {
  KeyBuilder key("rows", kRowsVersion);
  key.add(found_.key).add(option_numbers(options_.registry));
  for (const DatedEvidence& dated : evidence_) key.add(dated.scan_id).add(dated.date).add(shas_.at(dated.scan_id));
  const RowLayout layout = learned_from(evidence_.size());
  Derivation files(store_, writer, "", false);
  RAYFIELD_CHECK(files.get(kRowsKind, name_, key.hex(),
                           [&]() -> Result<tile::ArraySet> { return layout_to_arrays(layout, kRowsKind); }));
  for (const tile::DerivedEntry& entry : kept_) files.take(entry);
  if (own_.front().kind == kFoundKind) {
    files.take(own_.front());
  } else {  // of a store made before layouts learned
    KeyBuilder kept("found", kFoundVersion);
    kept.add(found_.key);
    RAYFIELD_CHECK(files.get(kFoundKind, name_, kept.hex(),
                             [&]() -> Result<tile::ArraySet> { return layout_to_arrays(found_.layout, kFoundKind); }));
  }
  RAYFIELD_CHECK(files.finish());
  return layout;
}

}  // namespace rayfield::density
