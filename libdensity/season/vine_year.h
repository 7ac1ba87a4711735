#pragma once

#include <optional>
#include <string>

#include "rayfield/tile/store.h"

/// The vine's year: when it bears leaves. Dates are YYYY-MM-DD, of scans of a store, which are checked when added.
namespace rayfield::density {

/// The months in which vines bear no leaves: June to 10 September south of 20° S, December to 10 March north of 20° N,
/// none between.
bool is_leafless_season(const std::string& date, double latitude_deg);

/// Three months of summer, when canopies are as large as they get: December to February south of 20° S, June to August
/// north of 20° N, none between.
bool is_full_leaf_season(const std::string& date, double latitude_deg);

/// Whether both dates lie between the middle of one winter and that of the next, when vines are pruned; within 20° of
/// the equator, or where the latitude is unknown, whether they are at most half a year apart.
bool in_one_season(const std::string& a, const std::string& b, std::optional<double> latitude_deg);

long days_between(const std::string& a, const std::string& b);

/// Of the middle of the scan, by the store's CRS; nothing where that cannot be told.
std::optional<double> latitude_of(const tile::ScanEntry& scan, const std::string& crs);

}  // namespace rayfield::density
