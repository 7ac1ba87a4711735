#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

/// Which scans of a block show bare wood, and which of them stands for the wood of another.
namespace rayfield::density {

/// What a scan tells about its season.
struct ScanSeason {
  std::string scan_id;
  std::string date;                        ///< YYYY-MM-DD
  std::optional<bool> declared;            ///< ScanEntry::dormant
  std::optional<double> plant_area_per_m;  ///< m² per metre of the panels that it shows; nothing: not processed
};

struct DormantVerdict {
  bool dormant = false;
  std::string reason;  ///< for a note; empty where nobody would ask: a date in the growing season
};

/// What the user declared; otherwise dormant are scans of the leafless months that show little: less than any scan of
/// the months with leaves, and no more than half of the largest of full leaf (three months of summer); where no scan of
/// those months has been processed, no more than 2 m² of plants per metre of row. Scans in the leafless months are not
/// held against each other: they may differ by the winter's pruning.
/// `latitude_deg`: nothing = unknown, then none is dormant unless declared.
std::vector<DormantVerdict> find_dormant_scans(std::span<const ScanSeason> scans, std::optional<double> latitude_deg);

/// The dormant scan nearest in time to scans[scan], itself if it is one; of two as near the earlier; only such as have
/// been processed. Nothing: none.
std::optional<std::size_t> wood_scan_of(std::size_t scan, std::span<const ScanSeason> scans,
                                        std::span<const DormantVerdict> verdicts);

/// The scan that shows the least plants per metre of those of one growing season with scans[scan], if that is at most ¾
/// of what scans[scan] shows: wood is no more than that, and scans of equal leaves do not change each other's. Seasons
/// go from the middle of one winter to that of the next, since vines are pruned in between; within 20° of the equator,
/// or where the latitude is unknown, half a year before and after. Of equals the earlier; only such as have been
/// processed. Nothing: none is that much barer.
std::optional<std::size_t> barest_scan_of(std::size_t scan, std::span<const ScanSeason> scans,
                                          std::optional<double> latitude_deg);

}  // namespace rayfield::density
