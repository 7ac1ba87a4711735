#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libdensity/learning/learn.h"
#include "libdensity/registry/layout_store.h"
#include "libdensity/scan/scan_stages.h"

namespace rayfield::density {

/// The block's layout while scans are being processed: what it starts from, what the scans that were processed earlier
/// have shown, and what those of this run show.
class BlockRegistry {
 public:
  /// Reads what the snapshot has of it. With options.redo for all scans, or options that ask for other rows or panels
  /// than the layout was found with, it is found anew, and keeps the identities of what stands at the same places.
  static Result<BlockRegistry> open(const tile::Store& store, const tile::Snapshot& snapshot,
                                    const ProcessOptions& options);

  bool known() const { return found_.known; }

  /// Finds the layout in this scan, or completes the survey by it.
  Result<void> adopt(ScanWork& work, const SurveyedScan& surveyed, tile::Store::DerivedWriter& writer);

  /// Adds what the scan shows, in place of what it showed before.
  Result<void> take_evidence(ScanWork& work, const SurveyedScan& surveyed);

  /// Whether the scan's evidence is known, from this run or an earlier one.
  bool has_evidence_of(const tile::ScanEntry& scan) const;
  /// The layout that the scan's evidence is gathered along: what scans before it have taught.
  RowLayout known_before(const tile::ScanEntry& scan);
  /// The layout as the scan takes it: what was known up to it.
  RowLayout layout_for(const tile::ScanEntry& scan);

  /// Takes back what the scan has taught: it could not be processed.
  void forget(const std::string& scan_id);

  /// Publishes the layout of today with the writer and returns it.
  Result<RowLayout> finish(tile::Store::DerivedWriter& writer);

  const std::vector<std::string>& notes() const { return notes_; }  ///< about finding the layout

 private:
  BlockRegistry(const tile::Store& store, const ProcessOptions& options) : store_(store), options_(options) {}
  const RowLayout& learned_from(std::size_t count);

  const tile::Store& store_;
  const ProcessOptions& options_;
  std::string name_;  // of its files
  BlockLayout survey_, found_, published_;
  std::vector<tile::DerivedEntry> kept_;     // of the registry: survey and names
  std::vector<tile::DerivedEntry> own_;      // what the layout starts from
  std::vector<DatedEvidence> evidence_;      // in the order of dates, then scans
  std::map<std::string, std::string> shas_;  // of the evidence's files, by scan
  std::optional<Learner> learner_;           // has taken the first `taken_` of the evidence
  std::size_t taken_ = 0;
  std::vector<std::string> notes_;
};

/// Names what of a layout a scan's results depend on: rows, panels, wood; not what they are called.
std::string geometry_key(const RowLayout& layout);

}  // namespace rayfield::density
