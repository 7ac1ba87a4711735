#include "libdensity/leaf_angles/leaf_angle_arrays.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libdensity/tiles/stored.h"

namespace rayfield::density {
namespace {

constexpr const char* kColumn = "fit";

}  // namespace

tile::ArraySet arrays_from_leaf_angles(const LeafAngleFit& fit) {
  tile::ArraySet arrays{.kind = kLeafAnglesKind, .attributes = "{}"};
  arrays.columns[kColumn] = std::vector<double>{fit.ln_ratio,
                                                fit.error,
                                                fit.measured ? 1.0 : 0.0,
                                                fit.aspect.mean_cosine,
                                                fit.aspect.apparent_side,
                                                fit.spherical_looks,
                                                fit.leverage,
                                                fit.wide_beams ? 1.0 : 0.0,
                                                fit.normals ? fit.normals->value : 0,
                                                fit.normals ? fit.normals->error : 0,
                                                fit.given ? 1.0 : 0.0,
                                                fit.lost_share};
  return arrays;
}

Result<LeafAngleFit> leaf_angles_from_arrays(const tile::ArraySet& arrays) {
  RAYFIELD_ASSIGN(const auto f, arrays.column<double>(kColumn));
  if (f.size() != 3 && f.size() != 4 && f.size() != 6 && f.size() != 7 && f.size() != 11 && f.size() != 12)
    return damaged(arrays, "the fit has another number of values");
  if (!std::isfinite(f[0]) || std::abs(f[0]) > 3 || !(f[1] >= 0)) return damaged(arrays, "the fit cannot be");
  LeafAngleFit fit{f[0], f[1], f[2] != 0};
  // Before version 2 taken for that of spherical leaves; the others came with version 4, the leverage with 5, normals
  // with 6, the lost share with 8.
  if (f.size() > 3) fit.aspect.mean_cosine = f[3];
  if (f.size() > 4) fit.aspect.apparent_side = f[4], fit.spherical_looks = f[5];
  if (f.size() > 6) fit.leverage = f[6];
  fit.wide_beams = f.size() > 7 ? f[7] != 0 : fit.spherical_looks == kSphericalLooksWide;
  if (f.size() > 9 && f[9] != 0) fit.normals = LnRatio{f[8], f[9]};
  if (f.size() > 10) fit.given = f[10] != 0;
  if (f.size() > 11) fit.lost_share = f[11];
  if (!(fit.aspect.mean_cosine > 0 && fit.aspect.mean_cosine <= 1)) return damaged(arrays, "the mean cosine cannot be");
  if (!(fit.aspect.apparent_side > 0) || !(std::abs(fit.spherical_looks) < 3) || !(fit.leverage >= 0))
    return damaged(arrays, "the leaves' aspect cannot be");
  if (!(fit.lost_share >= 0 && fit.lost_share <= 1)) return damaged(arrays, "so much cannot be lost");
  if (fit.normals && (!(std::abs(fit.normals->value) <= 3) || !(fit.normals->error > 0)))
    return damaged(arrays, "leaves cannot be turned like that");
  return fit;
}

}  // namespace rayfield::density
