#include "libdensity/pipeline/layout_products.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <map>

#include "libdensity/layout/polyline.h"
#include "rayfield/core/uuid.h"

namespace rayfield::density {
namespace {

// Centimetres name a place well enough; the same geometry is read back bit for bit from the layout.
std::string place(const Eigen::Vector2d& p) { return fmt::format("{:.2f} {:.2f}", p.x(), p.y()); }

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

std::string row_uid(const Row& row, const std::string& crs) {
  return named_uuid("rayfield row " + crs, place(row.centreline.front()) + " " + place(row.centreline.back()));
}

std::string panel_uid(const Panel& panel, const RowLayout& layout, const std::string& crs) {
  const Row* row = find_row(layout, panel.row);
  if (row == nullptr) return {};
  return named_uuid("rayfield panel " + crs, place(point_at(row->centreline, panel.start_m).position) + " " +
                                                 place(point_at(row->centreline, panel.end_m).position));
}

std::string post_uid(const Post& post, const std::string& crs) {
  return named_uuid("rayfield post " + crs, place(post.position));
}

BlockProducts layout_products(const RowLayout& layout, const std::string& block, const std::string& crs,
                              const GroundModel& ground, double half_width_m) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  BlockProducts products;
  products.block = block;
  products.crs = crs;
  for (const Row& row : layout.rows)
    products.rows.push_back({row_uid(row, crs), row.number, row.centreline, row.length_m(), layout.spacing_m});
  for (const Panel& panel : layout.panels) {
    const Row* row = find_row(layout, panel.row);
    if (row == nullptr) continue;
    products.panels.push_back({panel_uid(panel, layout, crs), panel.row, panel.number, panel.start_m, panel.end_m,
                               panel.end_m - panel.start_m, band(*row, panel.start_m, panel.end_m, half_width_m)});
  }
  for (const Post& post : layout.posts) {
    const std::optional<double> height = ground.height(post.position.x(), post.position.y());
    products.posts.push_back({post_uid(post, crs), post.row, post.chainage_m, post.position, height.value_or(kUnknown),
                              post.height_m, post.detected});
  }
  return products;
}

}  // namespace rayfield::density
