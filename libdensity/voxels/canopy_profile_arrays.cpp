#include "libdensity/voxels/canopy_profile_arrays.h"

#include <algorithm>
#include <vector>

#include "libdensity/tiles/stored.h"

namespace rayfield::density {
namespace {

// Histograms of several rows in one column, row after row.
Result<std::map<int, std::vector<std::int64_t>>> read_histograms(const tile::ArraySet& arrays, const std::string& name,
                                                                 std::span<const std::int32_t> rows, int bins) {
  const std::size_t n = static_cast<std::size_t>(bins);
  RAYFIELD_ASSIGN(const auto counts, stored_column<std::int64_t>(arrays, name, rows.size() * n));
  std::map<int, std::vector<std::int64_t>> out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto part = counts.subspan(i * n, n);
    out[rows[i]].assign(part.begin(), part.end());
  }
  return out;
}

}  // namespace

tile::ArraySet profile_to_arrays(const CanopyProfile& profile) {
  tile::ArraySet out;
  out.kind = "profile", out.version = 1;
  std::vector<std::int32_t> rows;
  std::vector<std::int64_t> across, up;
  for (const auto& [row, counts] : profile.across) {
    rows.push_back(row);
    across.insert(across.end(), counts.begin(), counts.end());
    const auto& ups = profile.up.at(row);
    up.insert(up.end(), ups.begin(), ups.end());
  }
  const std::size_t n = std::max<std::size_t>(1, rows.size());
  out.attributes = nlohmann::json{
      {"bin_m", profile.bin_m},
      {"half_width_m", profile.half_width_m},
      {"up_min_m", profile.up_min_m},
      {"across_bins", across.size() / n},
      {"up_bins",
       up.size() / n}}.dump();
  out.columns["row"] = std::move(rows), out.columns["across"] = std::move(across), out.columns["up"] = std::move(up);
  return out;
}

Result<CanopyProfile> profile_from_arrays(const tile::ArraySet& arrays) {
  RAYFIELD_ASSIGN(const nlohmann::json json, stored_attributes(arrays, "profile", 1));
  CanopyProfile profile;
  RAYFIELD_ASSIGN(profile.bin_m, stored_number(arrays, json, "bin_m"));
  RAYFIELD_ASSIGN(profile.half_width_m, stored_number(arrays, json, "half_width_m"));
  RAYFIELD_ASSIGN(profile.up_min_m, stored_number(arrays, json, "up_min_m"));
  RAYFIELD_ASSIGN(const int across, stored_count(arrays, json, "across_bins", 0, 100000));
  RAYFIELD_ASSIGN(const int up, stored_count(arrays, json, "up_bins", 0, 100000));
  RAYFIELD_ASSIGN(const auto rows, arrays.column<std::int32_t>("row"));
  RAYFIELD_ASSIGN(profile.across, read_histograms(arrays, "across", rows, across));
  RAYFIELD_ASSIGN(profile.up, read_histograms(arrays, "up", rows, up));
  return profile;
}

}  // namespace rayfield::density
