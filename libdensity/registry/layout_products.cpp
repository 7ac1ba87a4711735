#include "libdensity/registry/layout_products.h"

#include <cmath>
#include <limits>
#include <optional>

#include "libdensity/layout/polyline.h"

namespace rayfield::density {
namespace {

const Row* find_row(const RowLayout& layout, int number) {
  for (const Row& row : layout.rows)
    if (row.number == number) return &row;
  return nullptr;
}

// Ring around a part of a row, counter-clockwise and closed.
std::vector<Eigen::Vector2d> band(const Row& row, double start_m, double end_m, double half_width_m) {
  const std::vector<Eigen::Vector2d> line = sub_line(row.centreline, start_m, end_m);
  std::vector<Eigen::Vector2d> ring;
  const auto side = [&](std::size_t i, double across) {
    const Eigen::Vector2d along = (line[std::min(i + 1, line.size() - 1)] - line[i > 0 ? i - 1 : 0]).normalized();
    ring.emplace_back(line[i] + across * Eigen::Vector2d(-along.y(), along.x()));
  };
  for (std::size_t i = 0; i < line.size(); ++i) side(i, -half_width_m);
  for (std::size_t i = line.size(); i-- > 0;) side(i, half_width_m);
  ring.push_back(ring.front());
  return ring;
}

}  // namespace

BlockProducts layout_products(const RowLayout& layout, const std::string& block, const std::string& crs,
                              const GroundModel& ground, double half_width_m) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  BlockProducts products;
  products.block = block;
  products.crs = crs;
  for (const Row& row : layout.rows) {
    const Identity& id = row.identity;
    products.rows.push_back({id.uid, row.shown_number(), row.centreline, row.length_m(), layout.spacing_m, row.name,
                             id.valid_from, id.valid_to, id.source});
  }
  for (const Panel& panel : layout.panels) {
    const Row* row = find_row(layout, panel.row);
    if (row == nullptr) continue;
    const Identity& id = row->identity;  // a panel stands and falls with its row
    products.panels.push_back({panel.identity.uid, row->shown_number(), panel.number, panel.start_m, panel.end_m,
                               panel.end_m - panel.start_m, band(*row, panel.start_m, panel.end_m, half_width_m),
                               row->name, id.valid_from, id.valid_to, panel.identity.source});
  }
  for (const Post& post : layout.posts) {
    const Row* row = find_row(layout, post.row);
    if (row == nullptr) continue;
    const Identity& id = post.identity;
    const std::optional<double> height = ground.height(post.position.x(), post.position.y());
    products.posts.push_back({id.uid, row->shown_number(), post.chainage_m, post.position, height.value_or(kUnknown),
                              post.height_m, post.detected, row->name, id.valid_from, id.valid_to, id.source});
  }
  return products;
}

}  // namespace rayfield::density
