#include "libdensity/echoes/echo_model_arrays.h"

#include <cmath>

#include "libdensity/tiles/stored.h"

namespace rayfield::density {
namespace {

constexpr const char* kColumn = "model";

/// Places in kReturnModes, from 1 on; 0: not known.
double number_of(const std::optional<ReturnMode>& returns) {
  double number = 0;
  for (std::size_t i = 0; returns && i < kReturnModes.size(); ++i)
    if (kReturnModes[i].second == *returns) number = static_cast<double>(i + 1);
  return number;
}

std::vector<double> fields_of(const EchoModel& m) {
  return {m.full_echo,
          m.full_echo_error,
          m.detection_share,
          m.leaf_size_m2,
          static_cast<double>(m.leaf_size_from),
          m.echo_variation,
          m.mean_width_m,
          m.range_resolution_m,
          m.beam.diameter_m,
          m.beam.divergence_rad,
          0,  // until version 12 what was taken for the optical path of a range resolution
          m.lost_share,
          m.full_echo_per_cosine,
          m.lacking_share,
          m.unreturned_share,
          m.mean_echo_weight,
          m.lacks_downward_misses ? 1.0 : 0.0,
          number_of(m.beam.returns),
          m.resolution_assumed ? 1.0 : 0.0,
          m.leaves_per_resolution,
          m.wood_returned.value_or(0),
          m.leaf_normals ? m.leaf_normals->value : 0,
          m.leaf_normals ? m.leaf_normals->error : 0,
          m.range_resolution_error_m,
          m.wood_error,
          m.wood_brightness,
          m.wood_per_side,
          m.angle_slope};
}

}  // namespace

std::vector<double> model_numbers(const std::optional<EchoModel>& model) {
  return model ? fields_of(*model) : std::vector<double>{};
}

tile::ArraySet arrays_from_echo_model(const std::optional<EchoModel>& model) {
  tile::ArraySet arrays{.kind = kEchoModelKind, .attributes = "{}"};
  arrays.columns[kColumn] = model_numbers(model);
  return arrays;
}

Result<std::optional<EchoModel>> echo_model_from_arrays(const tile::ArraySet& arrays) {
  RAYFIELD_ASSIGN(const auto f, arrays.column<double>(kColumn));
  if (f.empty()) return std::nullopt;
  // A number that is not used any more came with version 3, the lost share with 4, what goes with the cosine with 6,
  // what follows with 11, what beams without an echo have met and the mean echo's weight with 12, what the cloud lacks
  // with 13, which echo the lidar reports with 14, whether the range resolution is assumed and how many leaves make an
  // echo together with 18, what echoes hold of bare wood with 19, how leaves are
  // turned with 22 (an error of 0: not told), how well the range resolution is known with 29, what areas are off by
  // wood's brightness with 30, that and how much wood there is with 31, how full echoes go with the angle with 35.
  constexpr std::size_t kOldest = 10;
  if (f.size() < kOldest || f.size() > fields_of({}).size())
    return damaged(arrays, "the model has another number of values");
  for (std::size_t i = 0; i < f.size(); ++i)
    if (!std::isfinite(f[i]) || (i < kOldest + 2 && f[i] < 0))
      return damaged(arrays, "the model has values that cannot be");
  EchoModel m{{f[8], f[9], {}}, f[7], f[0], f[1], f[2], f[3], {}, f[5], f[6]};
  if (f[4] > 2) return damaged(arrays, "the leaves' size is from nowhere");
  m.leaf_size_from = static_cast<LeafSizeFrom>(f[4]);
  if (f.size() > kOldest + 1) m.lost_share = f[kOldest + 1];
  if (f.size() > kOldest + 2) m.full_echo_per_cosine = f[kOldest + 2];
  if (f.size() > kOldest + 3) m.lacking_share = f[kOldest + 3];
  if (f.size() > kOldest + 4) m.unreturned_share = f[kOldest + 4];
  if (f.size() > kOldest + 5) m.mean_echo_weight = f[kOldest + 5];
  if (f.size() > kOldest + 6) m.lacks_downward_misses = f[kOldest + 6] != 0;
  if (const double returns = f.size() > kOldest + 7 ? f[kOldest + 7] : 0; returns != 0) {
    if (returns != std::floor(returns) || !(returns >= 1 && returns <= static_cast<double>(kReturnModes.size())))
      return damaged(arrays, "no lidar reports such an echo");
    m.beam.returns = kReturnModes[static_cast<std::size_t>(returns) - 1].second;
  }
  if (f.size() > kOldest + 8) m.resolution_assumed = f[kOldest + 8] != 0;
  if (f.size() > kOldest + 9) m.leaves_per_resolution = f[kOldest + 9];
  if (const double returned = f.size() > kOldest + 10 ? f[kOldest + 10] : 0; returned != 0) {
    if (!(returned > 0 && returned <= 1)) return damaged(arrays, "echoes of wood cannot hold that much");
    m.wood_returned = returned;
  }
  if (f.size() > kOldest + 12 && f[kOldest + 12] != 0) {
    m.leaf_normals = LnRatio{f[kOldest + 11], f[kOldest + 12]};
    if (!(m.leaf_normals->error > 0) || std::abs(m.leaf_normals->value) > 3)
      return damaged(arrays, "leaves cannot be turned like that");
  }
  if (f.size() > kOldest + 13) m.range_resolution_error_m = f[kOldest + 13];
  if (!(m.range_resolution_error_m >= 0)) return damaged(arrays, "the range resolution's error is negative");
  if (f.size() > kOldest + 14) m.wood_error = f[kOldest + 14];
  if (f.size() > kOldest + 16) m.wood_brightness = f[kOldest + 15], m.wood_per_side = f[kOldest + 16];
  if (f.size() > kOldest + 17) m.angle_slope = f[kOldest + 17];
  if (!(m.wood_error >= 0)) return damaged(arrays, "areas cannot be off that much by wood");
  if (!(m.wood_brightness > 0 && m.wood_per_side >= 0)) return damaged(arrays, "wood cannot be so dark, or so little");
  if (!(m.leaves_per_resolution >= 0)) return damaged(arrays, "leaves cannot be so few");
  if (!(m.mean_echo_weight >= 0 && m.mean_echo_weight <= 1)) return damaged(arrays, "echoes cannot weigh that much");
  if (!(m.unreturned_share >= 0)) return damaged(arrays, "beams without an echo cannot have met that");
  if (!(m.lacking_share >= 0 && m.lacking_share < 1)) return damaged(arrays, "full echoes cannot lack that much");
  if (!(m.full_echo > 0)) return damaged(arrays, "the full echo is 0");
  return m;
}

}  // namespace rayfield::density
