#include "surfel_match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "rayfield/core/parallel.h"

namespace rayfield::slam {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kChunk = 4096;

// Surfels of one level sorted by grid cell and copied in that order, so that a query walks contiguous memory.
class CellIndex {
 public:
  CellIndex(std::span<const PlacedSurfel> surfels, std::uint8_t level, double cell_m)
      : cell_(static_cast<float>(cell_m)), inverse_cell_(static_cast<float>(1 / cell_m)) {
    for (std::uint32_t k = 0; k < surfels.size(); ++k)
      if (surfels[k].level == level) order_.push_back({key_of(surfels[k].center), k});
    std::sort(order_.begin(), order_.end(),
              [](const Entry& a, const Entry& b) { return a.key != b.key ? a.key < b.key : a.index < b.index; });
    sorted_.reserve(order_.size());
    for (const Entry& e : order_) sorted_.push_back(surfels[e.index]);
    std::size_t capacity = 64;
    while (capacity < 2 * order_.size()) capacity *= 2;
    slots_.assign(capacity, {0, kNone, 0});
    for (std::size_t k = 0; k < order_.size();) {
      std::size_t end = k + 1;
      while (end < order_.size() && order_[end].key == order_[k].key) ++end;
      std::size_t s = hash(order_[k].key) & (capacity - 1);
      while (slots_[s].begin != kNone) s = (s + 1) & (capacity - 1);
      slots_[s] = {order_[k].key, static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(end)};
      k = end;
    }
  }

  std::size_t size() const { return order_.size(); }
  std::uint32_t surfel(std::size_t k) const { return order_[k].index; }

  // The surfel nearest to the k-th of the sorted ones, as an index into the surfels given; kNone if there is none.
  std::uint32_t nearest(std::size_t self, const MatchQuery& query, float radius_m) const {
    const PlacedSurfel& s = sorted_[self];
    const float scale2 = static_cast<float>(query.normal_scale_m * query.normal_scale_m);
    const float min_gap = static_cast<float>(query.min_gap_s), max_gap = static_cast<float>(query.max_gap_s);
    float best = radius_m * radius_m;
    std::uint32_t found = kNone;
    const Eigen::Vector3i c = cell_of(s.center);
    const Eigen::Vector3f inside = s.center - cell_ * c.cast<float>();
    for (const auto& [dx, dy, dz] : kAround) {
      // A neighbouring cell that begins further away than the best so far has nothing to offer.
      const float gx = gap(dx, inside.x()), gy = gap(dy, inside.y()), gz = gap(dz, inside.z());
      if (gx * gx + gy * gy + gz * gz > best) continue;
      const Slot* run = find(key(c.x() + dx, c.y() + dy, c.z() + dz));
      if (run == nullptr) continue;
      for (std::uint32_t k = run->begin; k < run->end; ++k) {
        const PlacedSurfel& o = sorted_[k];
        const float apart = std::abs(o.time_s - s.time_s);
        if (apart < min_gap || apart >= max_gap) continue;
        const float d = (o.center - s.center).squaredNorm() + scale2 * (o.normal - s.normal).squaredNorm();
        if (d < best || (d == best && order_[k].index < found)) best = d, found = order_[k].index;
      }
    }
    return found;
  }

 private:
  struct Entry {
    std::uint64_t key;
    std::uint32_t index;
  };
  struct Slot {
    std::uint64_t key;
    std::uint32_t begin, end;
  };
  struct Offset {
    int x, y, z;
  };
  // The cell itself, then the 26 around it from near to far.
  static constexpr std::array<Offset, 27> kAround = [] {
    std::array<Offset, 27> out{};
    std::size_t n = 0;
    for (int ring = 0; ring <= 3; ++ring)
      for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
          for (int x = -1; x <= 1; ++x)
            if (x * x + y * y + z * z == ring) out[n++] = {x, y, z};
    return out;
  }();
  float gap(int direction, float inside) const {
    return direction == 0 ? 0.0f : direction > 0 ? cell_ - inside : inside;
  }
  Eigen::Vector3i cell_of(const Eigen::Vector3f& p) const {
    return {static_cast<int>(std::floor(p.x() * inverse_cell_)), static_cast<int>(std::floor(p.y() * inverse_cell_)),
            static_cast<int>(std::floor(p.z() * inverse_cell_))};
  }
  static std::uint64_t key(int x, int y, int z) {
    const auto part = [](int v) { return static_cast<std::uint64_t>(v + (1 << 20)) & 0x1fffff; };
    return (part(x) << 42) | (part(y) << 21) | part(z);
  }
  std::uint64_t key_of(const Eigen::Vector3f& p) const {
    const Eigen::Vector3i c = cell_of(p);
    return key(c.x(), c.y(), c.z());
  }
  static std::uint64_t hash(std::uint64_t h) {
    h ^= h >> 33, h *= 0xff51afd7ed558ccdULL, h ^= h >> 33, h *= 0xc4ceb9fe1a85ec53ULL, h ^= h >> 33;
    return h;
  }
  const Slot* find(std::uint64_t k) const {
    std::size_t s = hash(k) & (slots_.size() - 1);
    while (slots_[s].begin != kNone) {
      if (slots_[s].key == k) return &slots_[s];
      s = (s + 1) & (slots_.size() - 1);
    }
    return nullptr;
  }

  float cell_, inverse_cell_;
  std::vector<Entry> order_;
  std::vector<PlacedSurfel> sorted_;
  std::vector<Slot> slots_;
};

}  // namespace

std::vector<PlacedSurfel> place_surfels(std::span<const Surfel> surfels, const PoseTrack& track,
                                        const Eigen::Vector3d& origin, int threads) {
  std::vector<PlacedSurfel> out(surfels.size());
  const std::size_t chunks = (surfels.size() + kChunk - 1) / kChunk;
  (void)parallel_for(chunks, threads, [&](std::size_t chunk, int) -> Result<void> {
    const std::size_t end = std::min(surfels.size(), (chunk + 1) * kChunk);
    for (std::size_t k = chunk * kChunk; k < end; ++k) {
      const Surfel& s = surfels[k];
      const Rigid3 pose = track.pose(s.time_s);
      const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
      const Eigen::Vector3d x = r * s.center.cast<double>() + pose.translation - origin;
      const Eigen::Vector3d n = r * s.normal.cast<double>();
      out[k] = {x.cast<float>(), n.cast<float>(), static_cast<float>(s.time_s), s.level, s.variance_m2};
    }
    return {};
  });
  return out;
}

std::vector<SurfelMatch> mutual_matches(std::span<const PlacedSurfel> surfels, std::span<const double> voxel_size_m,
                                        const MatchQuery& query, int threads) {
  std::vector<std::uint32_t> nearest(surfels.size(), kNone);
  for (std::size_t level = 0; level < voxel_size_m.size(); ++level) {
    const double radius = std::min(query.radius_voxels * voxel_size_m[level], query.max_radius_m);
    const CellIndex index(surfels, static_cast<std::uint8_t>(level), radius);
    const std::size_t chunks = (index.size() + kChunk - 1) / kChunk;
    (void)parallel_for(chunks, threads, [&](std::size_t chunk, int) -> Result<void> {
      const std::size_t end = std::min(index.size(), (chunk + 1) * kChunk);
      for (std::size_t k = chunk * kChunk; k < end; ++k) {
        nearest[index.surfel(k)] = index.nearest(k, query, static_cast<float>(radius));
      }
      return {};
    });
  }
  const double max_variance = query.max_thickness_m * query.max_thickness_m;
  const auto thin = [&](std::uint32_t k) { return static_cast<double>(surfels[k].variance_m2) <= max_variance; };
  std::vector<SurfelMatch> matches;
  for (std::uint32_t k = 0; k < nearest.size(); ++k)
    if (nearest[k] != kNone && nearest[k] > k && nearest[nearest[k]] == k && thin(k) && thin(nearest[k]))
      matches.push_back({k, nearest[k]});
  return matches;
}

}  // namespace rayfield::slam
