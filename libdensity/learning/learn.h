#pragma once
/// learning: the first layout of a block, what each later scan teaches about it, and landmarks for alignment.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libdensity/layout/row_layout.h"
#include "libdensity/learning/scan_evidence.h"
#include "rayfield/density/layout_options.h"

namespace rayfield::density {

/// What a scan showed, and when.
struct DatedEvidence {
  std::string scan_id, date;
  ScanEvidence evidence;
};

/// The layout as it comes to be known, date by date (docs/registry.md has the rules and their reasons). Nothing that a
/// scan teaches is in use before its own date: layout_on() of an earlier date is what it was. Row centrelines, panels
/// and identities of what was found first never change.
class Learner {
 public:
  /// `crs`: names what is new.
  Learner(RowLayout found, const RegistryOptions& options, const RowOptions& rows, std::string crs);

  /// Takes the next scan's evidence; they come in the order of their dates.
  void take(const DatedEvidence& dated);

  /// The layout as it is known now, with identities.
  const RowLayout& layout() const { return layout_; }

 private:
  struct KnownStem {  // a post or trunk of the registry, and whether the scan shows it
    double chainage_m = 0;
    Eigen::Vector2d position = Eigen::Vector2d::Zero();
    std::optional<std::size_t> post;  // index into RowLayout::posts; none: a trunk
    bool seen = false;
  };
  struct Absence {  // dates in a row on which something was missing
    std::string since;
    int dates = 0;
  };
  struct Candidate {  // a post that the registry does not know, on its way into it
    int row = 0;
    std::string first_date, first_scan, last_date;
    int dates = 0;
    Eigen::Vector2d position = Eigen::Vector2d::Zero();  // mean over the dates
  };

  static std::size_t count_seen(const std::vector<KnownStem>& known);
  std::vector<KnownStem> compare(const Row& row, const std::vector<PlacedStem>& stems) const;
  bool row_is_gone(Row& row, const DatedEvidence& dated, const std::vector<KnownStem>& known);
  bool well_observed(const std::vector<KnownStem>& known, std::size_t at) const;
  void learn_absent_posts(const std::vector<KnownStem>& known, const std::string& date);
  bool on_a_trunk(int row, const Eigen::Vector2d& p) const;
  Post* post_near(int row, const Eigen::Vector2d& p);
  void learn_present_posts(const Row& row, const std::vector<PlacedStem>& stems, const DatedEvidence& dated);
  void note_candidate(const Row& row, const Stem& stem, const DatedEvidence& dated);
  bool driven_before(const Row& row) const;
  void append_rows(const DatedEvidence& dated);
  void append_row(const RowLayout& found, const Row& candidate, const DatedEvidence& dated);

  RowLayout layout_;
  RegistryOptions options_;
  RowOptions row_options_;
  std::string crs_;
  double least_radius_m_ = 0;                    // thinner stems are trunks
  std::map<int, Absence> absent_rows_;           // by Row::number
  std::map<std::size_t, Absence> absent_posts_;  // by index into layout_.posts
  std::vector<Candidate> candidates_;
  std::vector<std::vector<Eigen::Vector2d>> passes_;  // of the scans so far
};

}  // namespace rayfield::density
