#include "sim/vines/trellis.h"

#include <algorithm>
#include <cmath>

namespace rayfield::sim {

std::vector<double> post_chainages(const SiteRows& rows) {
  std::vector<double> chainages;
  const int panels = std::max(1, static_cast<int>(std::ceil(rows.length_m / rows.panel_length_m - 1e-6)));
  for (int i = 0; i < panels; ++i) chainages.push_back(i * rows.panel_length_m);
  chainages.push_back(rows.length_m);
  return chainages;
}

void add_posts(const Ground& ground, int row, std::vector<Post>& posts, TriangleMesh& mesh) {
  const SiteStructure& structure = ground.site.structure;
  const std::vector<double> chainages = post_chainages(ground.site.rows);
  for (std::size_t i = 0; i < chainages.size(); ++i) {
    const bool strainer = i == 0 || i + 1 == chainages.size();
    Post post;
    post.row = row, post.post = static_cast<int>(i);
    post.chainage_m = chainages[i];
    post.position = ground.block.row_point(row, chainages[i]);
    post.ground_m = ground.terrain.height(post.position);
    post.height_m = strainer ? structure.strainer_height_m : structure.post_height_m;
    post.diameter_m = strainer ? structure.strainer_diameter_m : structure.post_diameter_m;
    post.kind = strainer ? PostKind::strainer : PostKind::line;
    Limb limb;
    limb.from = {post.position.x(), post.position.y(), post.ground_m - 0.2};
    limb.to = {post.position.x(), post.position.y(), post.ground_m + post.height_m};
    limb.from_diameter_m = limb.to_diameter_m = post.diameter_m;
    limb.cap_end = true;
    add_limb(mesh, limb);
    posts.push_back(post);
  }
}

void add_wires(const Ground& ground, int row, TriangleMesh& mesh) {
  constexpr double kPiece = 0.5;  // m; short pieces keep the boxes of the search tree small
  const SiteStructure& structure = ground.site.structure;
  const std::vector<double> chainages = post_chainages(ground.site.rows);
  for (const double height : structure.wire_heights_m)
    for (std::size_t i = 0; i + 1 < chainages.size(); ++i) {
      const Eigen::Vector3d from = ground.row_point(row, chainages[i], 0, height);
      const Eigen::Vector3d to = ground.row_point(row, chainages[i + 1], 0, height);
      const int pieces = std::max(1, static_cast<int>(std::ceil((to - from).norm() / kPiece)));
      for (int k = 0; k < pieces; ++k) {
        Limb limb;
        limb.from = from + (to - from) * (static_cast<double>(k) / pieces);
        limb.to = from + (to - from) * (static_cast<double>(k + 1) / pieces);
        limb.from_diameter_m = limb.to_diameter_m = structure.wire_diameter_m;
        limb.sides = 3;
        add_limb(mesh, limb);
      }
    }
}

}  // namespace rayfield::sim
