#include "libslam/surfels/surfel_match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "rayfield/core/parallel.h"

namespace rayfield::slam {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kChunk = 4096;
constexpr std::size_t kCellsPerTask = 128;

// The horizontal bounds of the surfels whose matches are wanted.
struct Bounds {
  Eigen::Array2f low = Eigen::Array2f::Constant(-std::numeric_limits<float>::infinity()), high = -low;
  bool contain(float x, float y) const { return x >= low.x() && x <= high.x() && y >= low.y() && y <= high.y(); }
};

Bounds bounds_of(std::span<const PlacedSurfel> surfels, std::span<const std::uint8_t> own) {
  Bounds bounds;
  if (own.empty()) return bounds;
  std::swap(bounds.low, bounds.high);
  for (std::size_t k = 0; k < surfels.size(); ++k)
    if (own[k] != 0) {
      bounds.low = bounds.low.min(surfels[k].center.head<2>().array());
      bounds.high = bounds.high.max(surfels[k].center.head<2>().array());
    }
  return bounds;
}

// Surfels of one level sorted by grid cell (z, then y, then x) in columns: the cells that a query has to look into are
// nine rows of three, each of them contiguous in memory, and distances to a row are taken with vector instructions.
class CellIndex {
 public:
  CellIndex(std::span<const PlacedSurfel> surfels, std::uint8_t level, double cell_m)
      : cell_(static_cast<float>(cell_m)), inverse_cell_(static_cast<float>(1 / cell_m)) {
    struct Entry {
      std::uint64_t key;
      std::uint32_t surfel;
    };
    std::vector<Entry> entries;
    for (std::uint32_t k = 0; k < surfels.size(); ++k)
      if (surfels[k].level == level) entries.push_back({key_of(surfels[k].center), k});
    std::sort(entries.begin(), entries.end(),
              [](const Entry& a, const Entry& b) { return a.key != b.key ? a.key < b.key : a.surfel < b.surfel; });
    surfel_.resize(entries.size());
    for (std::vector<float>& column : columns_) column.resize(entries.size());
    for (std::uint32_t at = 0; at < entries.size(); ++at) {
      const PlacedSurfel& s = surfels[entries[at].surfel];
      const std::array<float, kColumns> values = {s.center.x(), s.center.y(), s.center.z(), s.normal.x(),
                                                  s.normal.y(), s.normal.z(), s.time_s};
      for (std::size_t c = 0; c < kColumns; ++c) columns_[c][at] = values[c];
      surfel_[at] = entries[at].surfel;
      if (cells_.empty() || cells_.back().key != entries[at].key) cells_.push_back({entries[at].key, at, at});
      cells_.back().end = at + 1;
    }
  }

  std::size_t cells() const { return cells_.size(); }

  // Finds the nearest of every surfel within bounds in the cells [first, end); out and what it holds are indices into
  // the surfels given.
  void search(std::size_t first, std::size_t end, const MatchQuery& query, float radius_m, const Bounds& bounds,
              std::vector<float>& scratch, std::vector<std::uint32_t>& out) const {
    std::array<Row, 9> rows;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      rows[r].y = kRows[r][0], rows[r].z = kRows[r][1];
      rows[r].low = rows[r].high = static_cast<std::size_t>(
          std::lower_bound(cells_.begin(), cells_.end(), cells_[first].key + rows[r].offset() - 1,
                           [](const Cell& c, std::uint64_t key) { return c.key < key; }) -
          cells_.begin());
    }
    for (std::size_t cell = first; cell < end; ++cell) {
      const std::uint64_t key = cells_[cell].key;
      for (Row& row : rows) {  // keys grow, so that the rows only move forward
        while (row.low < cells_.size() && cells_[row.low].key < key + row.offset() - 1) ++row.low;
        while (row.high < cells_.size() && cells_[row.high].key <= key + row.offset() + 1) ++row.high;
        row.begin = row.low < row.high ? cells_[row.low].begin : 0;
        row.count = row.low < row.high ? cells_[row.high - 1].end - row.begin : 0;
        if (scratch.size() < row.count) scratch.resize(row.count);
      }
      for (std::uint32_t self = cells_[cell].begin; self < cells_[cell].end; ++self)
        if (bounds.contain(columns_[0][self], columns_[1][self]))
          out[surfel_[self]] = nearest(self, key, rows, query, radius_m, scratch);
    }
  }

 private:
  static constexpr std::size_t kColumns = 7, kTime = 6;  // center, normal, time
  static constexpr int kBits = 21;                       // of a key for each coordinate
  static constexpr std::int64_t kZero = 1 << (kBits - 1);
  // y and z of a row against a query's cell, from near to far.
  static constexpr int kRows[9][2] = {{0, 0}, {0, -1}, {0, 1}, {-1, 0}, {1, 0}, {-1, -1}, {-1, 1}, {1, -1}, {1, 1}};
  struct Cell {
    std::uint64_t key;
    std::uint32_t begin, end;
  };
  struct Row {
    int y = 0, z = 0;
    std::size_t low = 0, high = 0;       // cells
    std::uint32_t begin = 0, count = 0;  // surfels
    std::uint64_t offset() const {       // wraps for rows below, as keys do
      return (static_cast<std::uint64_t>(z) << (2 * kBits)) + (static_cast<std::uint64_t>(y) << kBits);
    }
  };

  std::uint32_t nearest(std::uint32_t self, std::uint64_t key, const std::array<Row, 9>& rows, const MatchQuery& query,
                        float radius_m, std::vector<float>& distance) const {
    const float inside_y = columns_[1][self] - cell_ * static_cast<float>(part(key >> kBits));
    const float inside_z = columns_[2][self] - cell_ * static_cast<float>(part(key >> (2 * kBits)));
    const float scale2 = static_cast<float>(query.normal_scale_m * query.normal_scale_m);
    const float min_gap = static_cast<float>(query.min_gap_s), max_gap = static_cast<float>(query.max_gap_s);
    const float time = columns_[kTime][self];
    float best = radius_m * radius_m;
    std::uint32_t found = kNone;
    for (const Row& row : rows) {
      // A row that begins further away than the best so far holds nothing nearer.
      const float gy = gap(row.y, inside_y), gz = gap(row.z, inside_z);
      if (row.count == 0 || gy * gy + gz * gz > best) continue;
      measure(self, row.begin, row.count, scale2, distance.data());
      for (std::uint32_t k = 0; k < row.count; ++k) {
        if (distance[k] > best) continue;
        const float apart = std::abs(columns_[kTime][row.begin + k] - time);
        if (apart < min_gap || apart >= max_gap) continue;
        const std::uint32_t surfel = surfel_[row.begin + k];
        if (distance[k] < best || surfel < found) best = distance[k], found = surfel;
      }
    }
    return found;
  }

  // d² to a run of surfels.
  void measure(std::uint32_t self, std::uint32_t begin, std::uint32_t count, float scale2,
               float* __restrict out) const {
    std::array<float, 6> s;
    std::array<const float*, 6> o;
    for (std::size_t c = 0; c < 6; ++c) s[c] = columns_[c][self], o[c] = columns_[c].data() + begin;
    for (std::uint32_t k = 0; k < count; ++k) {
      const float x = o[0][k] - s[0], y = o[1][k] - s[1], z = o[2][k] - s[2];
      const float nx = o[3][k] - s[3], ny = o[4][k] - s[4], nz = o[5][k] - s[5];
      out[k] = x * x + y * y + z * z + scale2 * (nx * nx + ny * ny + nz * nz);
    }
  }

  float gap(int direction, float inside) const {
    return direction == 0 ? 0.0f : direction > 0 ? cell_ - inside : inside;
  }
  static std::int64_t part(std::uint64_t shifted) {
    return static_cast<std::int64_t>(shifted & ((std::uint64_t{1} << kBits) - 1)) - kZero;
  }
  std::uint64_t key_of(const Eigen::Vector3f& p) const {
    std::uint64_t key = 0;
    for (int k = 2; k >= 0; --k) {
      const auto c = static_cast<std::int64_t>(std::floor(p[k] * inverse_cell_));
      key = (key << kBits) | static_cast<std::uint64_t>(std::clamp(c + kZero, std::int64_t{1}, 2 * kZero - 2));
    }
    return key;
  }

  float cell_, inverse_cell_;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> surfel_;  // indices into the surfels given
  std::array<std::vector<float>, kColumns> columns_;
};

}  // namespace

std::vector<PlacedSurfel> place_surfels(std::span<const Surfel> surfels, const PoseTrack& track,
                                        const Eigen::Vector3d& origin, int threads) {
  std::vector<PlacedSurfel> out(surfels.size());
  const std::size_t chunks = (surfels.size() + kChunk - 1) / kChunk;
  parallel_each(chunks, threads, [&](std::size_t chunk, int) {
    const std::size_t end = std::min(surfels.size(), (chunk + 1) * kChunk);
    for (std::size_t k = chunk * kChunk; k < end; ++k) {
      const Surfel& s = surfels[k];
      const Rigid3 pose = track.pose(s.time_s);
      const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
      const Eigen::Vector3d x = r * s.center.cast<double>() + pose.translation - origin;
      const Eigen::Vector3d n = r * s.normal.cast<double>();
      out[k] = {x.cast<float>(), n.cast<float>(), static_cast<float>(s.time_s), s.level, s.variance_m2};
    }
  });
  return out;
}

// Finds the nearest neighbour of every surfel, in parallel by runs of grid cells, and keeps the pairs that are nearest
// to each other.
std::vector<SurfelMatch> mutual_matches(std::span<const PlacedSurfel> surfels, std::span<const double> voxel_size_m,
                                        const MatchQuery& query, int threads, std::span<const std::uint8_t> own) {
  const std::size_t levels = voxel_size_m.size();
  const auto radius = [&](std::size_t level) {
    return std::min(query.radius_voxels * voxel_size_m[level], query.max_radius_m);
  };
  std::vector<std::optional<CellIndex>> index(levels);
  parallel_each(levels, threads, [&](std::size_t level, int) {
    index[level].emplace(surfels, static_cast<std::uint8_t>(level), radius(level));
  });
  std::vector<std::pair<std::size_t, std::size_t>> tasks;  // level and first cell
  for (std::size_t level = 0; level < levels; ++level)
    for (std::size_t cell = 0; cell < index[level]->cells(); cell += kCellsPerTask) tasks.emplace_back(level, cell);
  std::vector<std::uint32_t> nearest(surfels.size(), kNone);
  const Bounds wanted = bounds_of(surfels, own);
  std::vector<std::vector<float>> scratch(static_cast<std::size_t>(std::max(1, threads)));
  parallel_each(tasks.size(), threads, [&](std::size_t task, int worker) {
    const auto [level, first] = tasks[task];
    const std::size_t end = std::min(index[level]->cells(), first + kCellsPerTask);
    const auto reach = static_cast<float>(radius(level));
    index[level]->search(first, end, query, reach, {wanted.low - reach, wanted.high + reach},
                         scratch[static_cast<std::size_t>(worker)], nearest);
  });
  const double max_variance = query.max_thickness_m * query.max_thickness_m;
  const auto thin = [&](std::uint32_t k) { return static_cast<double>(surfels[k].variance_m2) <= max_variance; };
  std::vector<SurfelMatch> matches;
  for (std::uint32_t k = 0; k < nearest.size(); ++k)
    if (nearest[k] != kNone && nearest[k] > k && nearest[nearest[k]] == k && (own.empty() || own[k] != 0) && thin(k) &&
        thin(nearest[k]))
      matches.push_back({k, nearest[k]});
  return matches;
}

}  // namespace rayfield::slam
