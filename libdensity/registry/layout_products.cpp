#include "libdensity/registry/layout_products.h"

#include <limits>
#include <optional>

#include "libdensity/layout/polyline.h"
#include "libdensity/layout/ring_around.h"

namespace rayfield::density {
namespace {

const Row* find_row(const RowLayout& layout, int number) {
  for (const Row& row : layout.rows)
    if (row.number == number) return &row;
  return nullptr;
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
                               panel.end_m - panel.start_m,
                               ring_around(sub_line(row->centreline, panel.start_m, panel.end_m), half_width_m),
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
