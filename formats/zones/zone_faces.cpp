#include "formats/zones/zone_faces.h"

#include <ogr_api.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace rayfield::formats {
namespace {

/// Connected faces of one zone.
std::vector<std::size_t> parts_of(const std::vector<ZoneFace>& faces, const std::vector<SharedBorder>& borders) {
  std::vector<std::size_t> part(faces.size());
  std::iota(part.begin(), part.end(), 0);
  const auto root = [&](std::size_t i) {
    while (part[i] != i) i = part[i] = part[part[i]];
    return i;
  };
  for (const SharedBorder& border : borders)
    if (faces[border.a].zone == faces[border.b].zone) {
      const std::size_t a = root(border.a), b = root(border.b);
      part[std::max(a, b)] = std::min(a, b);
    }
  for (std::size_t i = 0; i < part.size(); ++i) part[i] = root(i);
  return part;
}

}  // namespace

std::vector<SharedBorder> shared_borders(const std::vector<ZoneFace>& faces) {
  std::vector<OGREnvelope> boxes(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) faces[i].polygon->getEnvelope(&boxes[i]);
  std::vector<SharedBorder> borders;
  for (std::size_t a = 0; a < faces.size(); ++a) {
    const std::unique_ptr<OGRGeometry> outline(faces[a].polygon->Boundary());
    for (std::size_t b = a + 1; b < faces.size(); ++b) {
      if (!boxes[a].Intersects(boxes[b])) continue;
      const std::unique_ptr<OGRGeometry> other(faces[b].polygon->Boundary());
      const std::unique_ptr<OGRGeometry> shared(outline->Intersection(other.get()));
      const double length = shared == nullptr ? 0 : OGR_G_Length(OGRGeometry::ToHandle(shared.get()));
      if (length > 0) borders.push_back({a, b, length});
    }
  }
  return borders;
}

void absorb_small_parts(std::vector<ZoneFace>& faces, const std::vector<SharedBorder>& borders, double min_area_m2) {
  for (;;) {
    const std::vector<std::size_t> part = parts_of(faces, borders);
    std::map<std::size_t, double> areas;
    for (std::size_t i = 0; i < faces.size(); ++i) areas[part[i]] += faces[i].area_m2;
    // The smallest part that has a neighbour; ties go to the first.
    std::map<std::size_t, std::map<int, double>> neighbours;  // by part: metres of border with each zone
    for (const SharedBorder& border : borders) {
      const std::size_t a = part[border.a], b = part[border.b];
      if (a == b) continue;
      neighbours[a][faces[border.b].zone] += border.length_m;
      neighbours[b][faces[border.a].zone] += border.length_m;
    }
    std::size_t smallest = faces.size();
    double area = min_area_m2;
    for (const auto& [id, size] : areas)
      if (size < area && neighbours.count(id) > 0) smallest = id, area = size;
    if (smallest == faces.size()) return;
    const auto& around = neighbours[smallest];
    const int zone = std::max_element(around.begin(), around.end(), [](const auto& x, const auto& y) {
                       return x.second < y.second;
                     })->first;
    for (std::size_t i = 0; i < faces.size(); ++i)
      if (part[i] == smallest) faces[i].zone = zone;
  }
}

}  // namespace rayfield::formats
