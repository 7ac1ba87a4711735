#include "libdensity/ground/lower_hull.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace rayfield::density {
namespace {

constexpr const char* kWhat = "cannot make a ground surface";

// Sum of outer products of deviations from the mean: its smallest eigenvalue is zero for points of lower rank.
template <int N>
double smallest_spread(const std::vector<Eigen::Matrix<double, N, 1>>& points) {
  Eigen::Matrix<double, N, 1> mean = Eigen::Matrix<double, N, 1>::Zero();
  for (const auto& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix<double, N, N> scatter = Eigen::Matrix<double, N, N>::Zero();
  for (const auto& p : points) scatter += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> solver(scatter / static_cast<double>(points.size()));
  return std::sqrt(std::max(0.0, solver.eigenvalues()(0)));
}

// What Qhull prints goes into memory: a library does not write to stderr.
struct MessageFile {
  char* text = nullptr;
  std::size_t size = 0;
  FILE* file = open_memstream(&text, &size);
  MessageFile() = default;
  MessageFile(const MessageFile&) = delete;
  MessageFile& operator=(const MessageFile&) = delete;
  ~MessageFile() {
    if (file) std::fclose(file);
    std::free(text);
  }
  std::string first_line() {
    if (!file) return "Qhull failed";
    std::fflush(file);
    const std::string all(text ? text : "", size);
    return all.substr(0, all.find('\n'));
  }
};

struct QhullFree {
  void operator()(qhT* qh) const {
    qh_freeqhull(qh, !qh_ALL);
    int blocks = 0, bytes = 0;
    qh_memfreeshort(qh, &blocks, &bytes);
    delete qh;
  }
};

// Vertices of a simplicial facet as positions in `points`, counter-clockwise seen from above.
std::array<int, 3> facet_vertices(qhT* qh, facetT* facet, const std::vector<Eigen::Vector3d>& points) {
  std::array<int, 3> v{};
  int n = 0;
  vertexT *vertex, **vertexp;
  FOREACHvertex_(facet->vertices) {
    if (n < 3) v[n] = qh_pointid(qh, vertex->point);
    ++n;
  }
  const Eigen::Vector2d a = points[static_cast<std::size_t>(v[0])].head<2>();
  const Eigen::Vector2d ab = points[static_cast<std::size_t>(v[1])].head<2>() - a;
  const Eigen::Vector2d ac = points[static_cast<std::size_t>(v[2])].head<2>() - a;
  if (ab.x() * ac.y() - ab.y() * ac.x() < 0) std::swap(v[1], v[2]);
  return v;
}

Result<LowerHull> hull_of(const std::vector<Eigen::Vector3d>& lifted) {
  MessageFile messages;
  if (!messages.file) return fail(ErrorCode::resources, kWhat, "", "no memory for Qhull's messages");
  std::unique_ptr<qhT, QhullFree> qh(new qhT);
  qh_zero(qh.get(), messages.file);
  std::vector<coordT> coordinates;
  coordinates.reserve(lifted.size() * 3);
  for (const Eigen::Vector3d& p : lifted) coordinates.insert(coordinates.end(), {p.x(), p.y(), p.z()});
  char command[] = "qhull Qt";
  if (qh_new_qhull(qh.get(), 3, static_cast<int>(lifted.size()), coordinates.data(), False, command, nullptr,
                   messages.file) != 0)
    return fail(ErrorCode::bad_input, kWhat, "convex hull", messages.first_line());

  LowerHull hull;
  facetT* facet;
  for (facet = qh->facet_list; facet && facet->next; facet = facet->next) {
    if (facet->upperdelaunay || !facet->simplicial || facet->normal[2] > -1e-9) continue;
    hull.triangles.push_back(facet_vertices(qh.get(), facet, lifted));
  }
  return hull;
}

}  // namespace

Result<LowerHull> lower_hull(std::span<const Eigen::Vector3d> points, double curvature_per_m) {
  std::vector<int> index;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].allFinite()) index.push_back(static_cast<int>(i)), centre += points[i];
  if (index.size() < 4) return fail(ErrorCode::bad_input, kWhat, "ground points", "fewer than four supported points");
  centre /= static_cast<double>(index.size());

  std::vector<Eigen::Vector3d> lifted;
  std::vector<Eigen::Vector2d> plan;
  for (int i : index) {
    const Eigen::Vector3d p = points[i] - centre;
    lifted.emplace_back(p.x(), p.y(), p.z() + curvature_per_m * p.head<2>().squaredNorm());
    plan.emplace_back(p.head<2>());
  }
  constexpr double kFlat = 1e-6;  // m; far below the resolution of the points, far above rounding
  if (smallest_spread<2>(plan) < kFlat)
    return fail(ErrorCode::bad_input, kWhat, "ground points", "all points lie on one line in plan");
  if (smallest_spread<3>(lifted) < kFlat)
    return fail(ErrorCode::bad_input, kWhat, "ground points", "the lifted points lie in one plane");

  RAYFIELD_ASSIGN(LowerHull hull, hull_of(lifted));
  for (auto& triangle : hull.triangles)
    for (int& v : triangle) v = index[v];
  return hull;
}

}  // namespace rayfield::density
