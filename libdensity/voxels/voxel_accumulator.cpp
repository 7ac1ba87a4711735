#include "libdensity/voxels/voxel_accumulator.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "libdensity/voxels/beam_neighbours.h"
#include "libdensity/voxels/ray_gaps.h"
#include "libdensity/voxels/tile_ground.h"
#include "libdensity/voxels/voxel_index.h"
#include "libdensity/voxels/voxel_traversal.h"

namespace rayfield::density {
namespace {

constexpr double kFreshM = 1.5;   // inside grids, for DirectionCounters of beams that are not thin
constexpr double kGrassM = 0.25;  // above the ground, what grows at the foot of posts and trunks

/// Whether a place is among a share of all places, in squares of half a metre.
bool is_kept(const Eigen::Vector2d& place, double share) {
  constexpr double kSquareM = 0.5;
  const auto number = [](double m) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(m))); };
  std::uint64_t mixed = number(place.x() / kSquareM) * 0x9E3779B97F4A7C15u ^ number(place.y() / kSquareM);
  mixed = (mixed ^ (mixed >> 31)) * 0xBF58476D1CE4E5B9u;
  mixed ^= mixed >> 29;
  return static_cast<double>(mixed >> 11) * 0x1p-53 < share;
}

bool same_grid(const RowSegment& a, const RowSegment& b) {
  return a.row == b.row && a.index == b.index && a.shape() == b.shape();
}

}  // namespace

struct VoxelAccumulator::Geometry {
  VoxelOptions options;
  LeafProjectionTable projection{LeafAngles{}};
  tile::TileIndex tile;
  std::vector<GridFrame> frames;
  std::vector<WoodCylinder> wood;
  VoxelIndex index;
  TileGround ground;
  std::shared_ptr<const BeamView> view;  // of beams that are not thin

  bool left_out(const Eigen::Vector3d& p, const Eigen::Vector3d& d) const {
    return options.sure_return_m > 0 && !ground.sure_to_return(p, d, options.sure_return_m, options.slope_margin);
  }
};

VoxelAccumulator::VoxelAccumulator(std::shared_ptr<const Geometry> geometry, std::vector<RowSegmentVoxels> empty)
    : geometry_(std::move(geometry)), sums_(std::move(empty)) {}

Result<VoxelAccumulator> VoxelAccumulator::create(const tile::TileRef& tile, std::span<const RowSegment> row_segments,
                                                  std::span<const WoodCylinder> wood, const VoxelOptions& options,
                                                  std::shared_ptr<const BeamView> view) {
  RAYFIELD_CHECK(options.validate());
  auto geometry = std::make_shared<Geometry>();
  geometry->options = options;
  geometry->projection = LeafProjectionTable(options.leaf_angles);
  geometry->tile = tile.index;
  geometry->view = std::move(view);
  std::vector<RowSegment> kept;
  std::vector<RowSegmentVoxels> empty;
  double voxel_m = 0;
  for (const RowSegment& s : row_segments) {
    const std::string where = "row " + std::to_string(s.row) + ", row segment " + std::to_string(s.index);
    const std::int64_t columns = std::int64_t{s.n_along} * s.n_across;
    if (s.n_along <= 0 || s.n_across <= 0 || s.n_up <= 0 || columns * s.n_up > kMostVoxels)
      return fail(ErrorCode::usage, "cannot lay out voxels", where, "no voxels, or more than 2^28",
                  "check the row's extents");
    if (!(s.voxel_m > 0) || !(std::abs(s.direction.norm() - 1) < 1e-6))
      return fail(ErrorCode::usage, "cannot lay out voxels", where,
                  "voxel size not positive or direction not a unit vector");
    RowSegmentVoxels voxels = empty_voxels(s, tile, geometry->view != nullptr);
    if (voxels.entries.empty()) continue;
    kept.push_back(s);
    geometry->frames.emplace_back(s);
    empty.push_back(std::move(voxels));
    voxel_m = std::max(voxel_m, s.voxel_m);
  }
  // Columns reach over the tile's border by at most half a voxel diagonal.
  const Eigen::Vector2d corner = tile.corner();
  Eigen::AlignedBox2d bounds(Eigen::Vector2d(corner.array() - voxel_m),
                             Eigen::Vector2d(corner.array() + tile.size_m + voxel_m));
  for (const WoodCylinder& w : wood)
    if (bounds.exteriorDistance(Eigen::Vector2d(w.base.head<2>())) < w.length_m + 1) geometry->wood.push_back(w);
  geometry->index = VoxelIndex(kept, geometry->wood, options.wood_shell_m, bounds);
  geometry->ground = TileGround::of(kept);
  return VoxelAccumulator(geometry, std::move(empty));
}

void VoxelAccumulator::count_directions_only(std::size_t first, std::size_t count) {
  counts_directions_ = true, counts_pairs_ = false;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    if (first <= i && i < first + count) sums_[i].directions.assign(sums_[i].voxels.size(), {});
    sums_[i].voxels = {}, sums_[i].echoes = {};
  }
}

void VoxelAccumulator::count_pairs_only() {
  for (RowSegmentVoxels& sums : sums_) sums.voxels = {}, sums.echoes = {};
}

std::vector<std::size_t> VoxelAccumulator::voxel_counts() const {
  std::vector<std::size_t> counts;
  for (const RowSegmentVoxels& sums : sums_) counts.push_back(sums.voxels.size());
  return counts;
}

std::size_t VoxelAccumulator::bytes() const { return counter_bytes(sums_); }

bool VoxelAccumulator::empty() const { return sums_.empty(); }

template <class Meet>
void VoxelAccumulator::for_rays(const tile::SegmentBatch& segments, Meet meet) {
  std::vector<std::uint64_t> mask(static_cast<std::size_t>(geometry_->index.words()));
  const BeamView* const view = geometry_->view.get();
  EchoStatistics* const statistics = statistics_ ? &*statistics_ : nullptr;
  std::size_t track_hint = 0;
  BeamNeighbours neighbours;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Eigen::Vector3d p = segments.entry[i];
    Eigen::Vector3d d = segments.exit[i] - p;
    const double length = d.norm();
    const bool hit = (segments.flags[i] & tile::kHit) != 0;
    Counted counted;
    if (length > 0) {
      d /= length;
      const bool left_out = geometry_->left_out(p, d);
      if (!left_out) {
        Ray ray{p, d, length, hit, (segments.flags[i] & tile::kStartsHere) != 0};
        if (view != nullptr) {
          ray.range_m = std::max(0.0, (p - view->track.position(segments.time_s[i], track_hint)).dot(d));
          ray.intensity = segments.intensity[i];
          const double followed_m = std::max(0.0, view->followed_m - ray.range_m);
          if (length > followed_m) ray.length = followed_m, ray.hit = false;
        }
        if (ray.length > 0) counted = meet(ray, mask);
        if (statistics != nullptr) add_echo(ray, counted);
      }
      const bool may_pair = counts_pairs_ && !left_out && !counted.on_wood;
      const auto beside = may_pair ? neighbours.on_leaf_beside(d, segments.time_s[i]) : std::nullopt;
      if (beside) {
        const Eigen::Vector3d to_hit = segments.exit[beside->number] - p;
        const double along = to_hit.dot(d), distance = (to_hit - along * d).norm();
        pairs_.add(distance, length - along, hit);
        if (statistics != nullptr) {
          statistics->add_pair(segments.intensity[beside->number], segments.intensity[i], distance, length - along,
                               hit);
          if (beside->same_beam && distance < LeafSizePairs::kCloseM) statistics->add_same_beam_beside();
        }
      }
    }
    if (counts_pairs_) neighbours.add(i, d, segments.time_s[i], counted.hit);
  }
}

void VoxelAccumulator::add_echo(const Ray& ray, const Counted& counted) {
  const double width_m = geometry_->view->beam.diameter_at(ray.range_m + ray.length);
  if (counted.wood != nullptr) {
    const WoodCylinder& wood = *counted.wood;
    const double beside = distance_from_axis(wood, ray.origin, ray.direction);
    const double up = (ray.origin + ray.length * ray.direction - wood.base).dot(wood.axis);
    statistics_->add_stem_echo(ray.intensity,
                               {wood.is_trunk(), beside + width_m / 2 < wood.radius_m, /*above_grass=*/up > kGrassM});
  }
  if (counted.on_ground) statistics_->add_ground_echo(ray.intensity, geometry_->ground.cosine_to(ray.direction));
  if (!counted.hit) return;
  statistics_->add_echo(ray.intensity, width_m);
  const Eigen::Vector3d end = ray.origin + ray.length * ray.direction;
  if (is_kept(end.head<2>(), kept_share_))
    leaf_echoes_.push_back({(end - geometry_->ground.center).cast<float>(), ray.direction.cast<float>(),
                            static_cast<float>(width_m), ray.intensity});
}

Result<void> VoxelAccumulator::add(const tile::SegmentBatch& segments) {
  segments_ += segments.size();
  if (segments_ > std::numeric_limits<std::uint32_t>::max())
    return fail(ErrorCode::resources, "cannot count rays",
                "tile " + std::to_string(geometry_->tile.ix) + "_" + std::to_string(geometry_->tile.iy),
                "more than 4294967295 segments in one tile", "use smaller tiles");
  if (sums_.empty()) return {};
  for_rays(segments, [this](const Ray& ray, std::vector<std::uint64_t>& mask) -> Counted {
    const double behind_m = ray.hit && geometry_->view ? geometry_->view->behind_m : 0;
    if (!geometry_->index.candidates(ray.origin, ray.direction, ray.length + behind_m, mask.data())) return {};
    return count(ray, mask);
  });
  return {};
}

void VoxelAccumulator::add_pairs(const tile::SegmentBatch& segments) {
  if (sums_.empty()) return;
  if (geometry_->view && !statistics_) statistics_.emplace();
  for_rays(segments, [this](const Ray& ray, std::vector<std::uint64_t>& mask) -> Counted {
    if (!ray.hit) return {};
    if (geometry_->index.candidates(ray.origin, ray.direction, ray.length, mask.data())) return locate_hit(ray, mask);
    return {.on_ground = geometry_->ground.is_near(ray.origin + ray.length * ray.direction)};
  });
}

VoxelAccumulator::Counted VoxelAccumulator::locate_hit(const Ray& ray, std::vector<std::uint64_t>& mask) const {
  const Geometry& g = *geometry_;
  const Eigen::Vector3d end = ray.origin + ray.length * ray.direction;
  Counted out;
  for (std::size_t w = mask.size(); w-- > 0;)
    for (std::uint64_t bits = std::exchange(mask[w], 0); bits != 0; bits &= bits - 1) {
      const std::size_t item = w * 64 + static_cast<std::size_t>(std::countr_zero(bits));
      if (item >= sums_.size()) {
        Interval gap{};
        const WoodCylinder& wood = g.wood[item - sums_.size()];
        if (shell_interval(wood, g.options.wood_shell_m, ray.origin, ray.direction, gap.from, gap.to) &&
            gap.from <= ray.length && ray.length <= gap.to)
          out.on_wood = true, out.wood = &wood;
        continue;
      }
      const RowSegment& s = sums_[item].row_segment;
      const Eigen::Array3d at = g.frames[item].grid_from_map(end).array().floor();
      if ((at < 0).any() || (at >= Eigen::Array3d(s.n_along, s.n_across, s.n_up)).any()) continue;
      const std::size_t column = s.shape().column(static_cast<int>(at.x()), static_cast<int>(at.y()));
      out.hit = out.hit || sums_[item].column[column] >= 0;
    }
  out.hit = out.hit && !out.on_wood;
  return out;
}

VoxelAccumulator::Counted VoxelAccumulator::count(const Ray& ray, std::vector<std::uint64_t>& mask) {
  const Geometry& g = *geometry_;
  const auto segment_bits = sums_.size();
  Gaps gaps;
  std::array<Interval, kMaxGaps + 1> pieces;
  std::size_t piece_count = 1;
  pieces[0] = {0, ray.length};
  Counted counted;
  candidates_.clear();
  for (std::size_t w = mask.size(); w-- > 0;) {  // from the top: wood comes before the row segments
    for (std::uint64_t bits = std::exchange(mask[w], 0); bits != 0;) {
      const auto top = static_cast<std::size_t>(63 - std::countl_zero(bits));
      bits &= ~(std::uint64_t{1} << top);
      const std::size_t item = w * 64 + top;
      if (item < segment_bits) {
        candidates_.push_back(item);
        continue;
      }
      Interval gap{};
      if (!shell_interval(g.wood[item - segment_bits], g.options.wood_shell_m, ray.origin, ray.direction, gap.from,
                          gap.to) ||
          gap.to <= 0 || gap.from >= ray.length)
        continue;
      gaps.insert(gap);
      piece_count = gaps.pieces(ray.length, pieces);
      counted.on_wood = ray.hit && gaps.covers(ray.length);
    }
  }
  const double doubled_projection = 2 * g.projection(ray.direction.z());
  const std::size_t steepness = DirectionCounters::steepness_of(ray.direction.z());
  std::array<RayPiece, kMaxGaps + 1> ray_pieces;
  for (std::size_t k = 0; k < piece_count; ++k)
    ray_pieces[k] = {pieces[k].from,
                     pieces[k].to,
                     doubled_projection,
                     ray.hit && pieces[k].to == ray.length,
                     k == 0,
                     ray.starts && pieces[k].from == 0,
                     steepness};
  const std::span<const RayPiece> whole(ray_pieces.data(), piece_count);
  if (counts_directions_) {
    count_directions(ray, whole, counted.on_wood);
    return counted;
  }
  if (g.view) {
    counted.hit = count_wide(ray, whole, counted.on_wood);
    return counted;
  }
  for (const std::size_t item : candidates_) {
    const Eigen::Vector3d g0 = g.frames[item].grid_from_map(ray.origin), dg = g.frames[item].linear * ray.direction;
    for (const RayPiece& piece : whole)
      if (traverse<false>(sums_[item], g0, dg, piece, {})) counted.hit = true;
  }
  return counted;
}

void VoxelAccumulator::meet_grids(const Ray& ray, double end) {
  met_.clear();
  for (const std::size_t item : candidates_) {
    const Eigen::Vector3d g0 = geometry_->frames[item].grid_from_map(ray.origin);
    const Eigen::Vector3d dg = geometry_->frames[item].linear * ray.direction;
    const Shape3 shape = sums_[item].row_segment.shape();
    GridChord chord{0, end, -1};
    if (clip_to_grid({shape.ni, shape.nj, shape.nk}, g0, dg, chord))
      met_.push_back({item, g0, dg, chord.from, chord.to});
  }
  std::sort(met_.begin(), met_.end(),
            [](const Met& a, const Met& b) { return a.from != b.from ? a.from < b.from : a.item < b.item; });
}

bool VoxelAccumulator::count_wide(const Ray& ray, std::span<const RayPiece> pieces, bool on_wood) {
  const Geometry& g = *geometry_;
  const double end = ray.length + (ray.hit && !on_wood ? g.view->behind_m : 0);
  const double doubled_projection = 2 * g.projection(ray.direction.z());
  meet_grids(ray, end);
  const WideRay wide{g.view->beam.diameter_at(ray.range_m), g.view->beam.divergence_rad, ray.intensity};
  bool hit = false;
  for (const Met& met : met_) {
    RowSegmentVoxels& sums = sums_[met.item];
    for (const RayPiece& piece : pieces)
      if (traverse<true>(sums, met.g0, met.dg, piece, wide)) hit = true;
    if (end > ray.length)
      add_behind(sums, met.g0, met.dg, {ray.length, end, doubled_projection, false, false, false}, ray.intensity);
  }
  return hit;
}

void VoxelAccumulator::count_directions(const Ray& ray, std::span<const RayPiece> pieces, bool on_wood) {
  const Geometry& g = *geometry_;
  double end = ray.length, passed = 0, fresh_m = std::numeric_limits<double>::infinity();
  DirectedRay directed{0, 0, 1};
  if (g.view) {
    if (ray.hit && !on_wood) end += g.view->behind_m;
    passed = std::max(0.0, 1 - ray.intensity / g.view->full_echo), fresh_m = kFreshM;
    directed = {ray.range_m, 1, ray.intensity};
  }
  const double range_m = directed.range_at_origin_m + directed.range_per_m * ray.length;
  meet_grids(ray, end);
  for (const Met& met : met_) {
    if (!(fresh_m > 0)) return;
    const double until = met.from + fresh_m;
    fresh_m -= met.to - met.from;
    if (sums_[met.item].directions.empty()) continue;
    for (RayPiece piece : pieces) {
      piece.hit = piece.hit && piece.to <= until, piece.to = std::min(piece.to, until);
      if (piece.from < piece.to) add_directions(sums_[met.item], met.g0, met.dg, piece, directed);
    }
    if (const double last = std::min(end, until); last > ray.length)
      add_directions_behind(sums_[met.item], met.g0, met.dg,
                            {ray.length, last, 0, false, false, false, pieces.front().steepness}, passed, range_m);
  }
}

Result<void> VoxelAccumulator::merge(const VoxelAccumulator& other) {
  segments_ += other.segments_;
  if (segments_ > std::numeric_limits<std::uint32_t>::max() || sums_.size() != other.sums_.size())
    return fail(ErrorCode::internal, "cannot merge voxel counts", "tile",
                "too many segments or different row segments");
  pairs_ += other.pairs_;
  leaf_echoes_.insert(leaf_echoes_.end(), other.leaf_echoes_.begin(), other.leaf_echoes_.end());
  if (other.statistics_) {
    if (!statistics_) statistics_.emplace();
    statistics_->merge(*other.statistics_);
  }
  for (std::size_t s = 0; s < sums_.size(); ++s) {
    RowSegmentVoxels& mine = sums_[s];
    const RowSegmentVoxels& theirs = other.sums_[s];
    if (!same_grid(mine.row_segment, theirs.row_segment) || mine.voxels.size() != theirs.voxels.size() ||
        mine.echoes.size() != theirs.echoes.size() || mine.directions.size() != theirs.directions.size())
      return fail(ErrorCode::internal, "cannot merge voxel counts", "tile", "different row segments");
    for (std::size_t i = 0; i < mine.voxels.size(); ++i) mine.voxels[i] += theirs.voxels[i];
    for (std::size_t i = 0; i < mine.echoes.size(); ++i) mine.echoes[i] += theirs.echoes[i];
    for (std::size_t i = 0; i < mine.directions.size(); ++i) mine.directions[i] += theirs.directions[i];
    for (std::size_t i = 0; i < mine.entries.size(); ++i) mine.entries[i] += theirs.entries[i];
  }
  return {};
}

TileVoxels VoxelAccumulator::finish() && { return {geometry_->tile, std::move(sums_), pairs_}; }

}  // namespace rayfield::density
