#include "rayfield/core/map_frame.h"

#include <fmt/core.h>
#include <proj.h>

#include <Eigen/LU>
#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>

namespace rayfield {
namespace {

struct ContextDeleter {
  void operator()(PJ_CONTEXT* c) const { proj_context_destroy(c); }
};
struct PjDeleter {
  void operator()(PJ* p) const { proj_destroy(p); }
};
using ContextPtr = std::unique_ptr<PJ_CONTEXT, ContextDeleter>;
using PjPtr = std::unique_ptr<PJ, PjDeleter>;

// Whether PROJ has complained of its database in this thread: its functions give nothing then, as for a CRS that it
// does not know.
thread_local bool database_failed = false;

ContextPtr make_context() {
  ContextPtr context(proj_context_create());
  // Nothing reaches stderr.
  proj_log_func(context.get(), nullptr, [](void* /*app*/, int /*level*/, const char* text) {
    const std::string_view said = text == nullptr ? "" : text;
    if (said.find("SQLite error") != std::string_view::npos || said.find("proj.db") != std::string_view::npos)
      database_failed = true;
  });
  proj_log_level(context.get(), PJ_LOG_ERROR);
  proj_context_set_enable_network(context.get(), 0);
  return context;
}

tl::unexpected<Error> bad_crs(const std::string& code, std::string_view why) {
  return fail(
      ErrorCode::usage, "cannot use coordinate reference system", code, why,
      "give a projected CRS in metres, e.g. EPSG:7854 (GDA2020 / MGA zone 54) or EPSG:32633 (WGS 84 / UTM zone 33N)");
}

// Why a CRS could not be made: a database that cannot be opened or read says nothing about the CRS.
Error unknown_crs(PJ_CONTEXT* context, const std::string& code) {
  if (proj_context_get_database_path(context) != nullptr && !database_failed)
    return bad_crs(code, "PROJ does not know it").value();
  return fail(ErrorCode::resources, "cannot look up coordinate reference system", code,
              "PROJ cannot read its database, proj.db",
              "check that the package proj-data is installed, that PROJ_LIB, where set, names its folder, and that "
              "files can be opened (ulimit -n)")
      .value();
}

constexpr double kScaleTolerance = 0.01, kMaxConvergence_deg = 60, kMaxOutside_deg = 10, kNearOrigin_m = 1000;

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n"), last = text.find_last_not_of(" \t\r\n");
  return first == std::string::npos ? std::string() : text.substr(first, last - first + 1);
}

// Latitudes and longitudes for which a CRS is made.
struct AreaOfUse {
  double west_deg = 0, south_deg = 0, east_deg = 0, north_deg = 0;

  /// How far a place lies outside, in degrees; 0 inside.
  double distance_deg(double latitude_deg, double longitude_deg) const {
    const double width_deg = east_deg - west_deg + (east_deg < west_deg ? 360 : 0);
    const double from_west_deg = longitude_deg - west_deg - 360 * std::floor((longitude_deg - west_deg) / 360);
    const double beside_deg = from_west_deg <= width_deg ? 0 : std::min(from_west_deg - width_deg, 360 - from_west_deg);
    return std::max({0.0, beside_deg, south_deg - latitude_deg, latitude_deg - north_deg});
  }
};

std::optional<AreaOfUse> area_of(PJ_CONTEXT* context, const PJ* crs) {
  constexpr double kUnknown = -1000;
  AreaOfUse area;
  if (proj_get_area_of_use(context, crs, &area.west_deg, &area.south_deg, &area.east_deg, &area.north_deg, nullptr) ==
          0 ||
      area.west_deg == kUnknown)
    return std::nullopt;
  return area;
}

// The horizontal part of a compound CRS, or the CRS itself.
PjPtr horizontal_part(PJ_CONTEXT* context, PjPtr crs) {
  if (proj_get_type(crs.get()) == PJ_TYPE_COMPOUND_CRS) return PjPtr(proj_crs_get_sub_crs(context, crs.get(), 0));
  return crs;
}

// Letters and digits alone, in lower case: "GDA2020_MGA_Zone_54" is "GDA2020 / MGA zone 54".
std::string plain_name(std::string_view text) {
  std::string name;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

// What is no code, WKT, JSON or PROJ string is a name to PROJ, which gives whatever bears a similar one: for "foo"
// Amersfoort.
bool is_similar_only(const std::string& text, const PJ* crs) {
  return text.find_first_of(":[{=") == std::string::npos && plain_name(text) != plain_name(proj_get_name(crs));
}

Result<PjPtr> open_projected(PJ_CONTEXT* context, const std::string& code) {
  database_failed = false;
  PjPtr crs(proj_create(context, trimmed(code).c_str()));
  if (!crs) return tl::make_unexpected(unknown_crs(context, code));
  if (!proj_is_crs(crs.get())) return bad_crs(code, "PROJ does not know it");
  if (is_similar_only(code, crs.get()))
    return bad_crs(code, fmt::format("PROJ does not know it; the most similar is '{}'", proj_get_name(crs.get())));
  crs = horizontal_part(context, std::move(crs));
  const PJ_TYPE type = proj_get_type(crs.get());
  if (type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS || type == PJ_TYPE_GEOCENTRIC_CRS)
    return bad_crs(code, "it is geographic (degrees); areas and voxels need metres");
  if (type != PJ_TYPE_PROJECTED_CRS) return bad_crs(code, "it is not a projected CRS");
  const PjPtr axes(proj_crs_get_coordinate_system(context, crs.get()));
  for (int axis = 0; axis < 2; ++axis) {
    const char* direction = nullptr;
    double unit = 0;
    if (!axes || !proj_cs_get_axis_info(context, axes.get(), axis, nullptr, nullptr, &direction, &unit, nullptr,
                                        nullptr, nullptr))
      return bad_crs(code, "its axes are unknown");
    if (std::abs(unit - 1.0) > 1e-12) return bad_crs(code, "its axes are not in metres");
    const std::string_view d(direction);
    if (d != "east" && d != "north") return bad_crs(code, "its axes do not point east and north");
  }
  return crs;
}

// "EPSG:7854", also of a compound CRS; as given where it has no code.
std::string code_of(PJ_CONTEXT* context, const std::string& given) {
  const PjPtr crs(proj_create(context, trimmed(given).c_str()));
  const char* authority = crs ? proj_get_id_auth_name(crs.get(), 0) : nullptr;
  const char* code = crs ? proj_get_id_code(crs.get(), 0) : nullptr;
  if (authority == nullptr || code == nullptr) return trimmed(given);
  return std::string(authority) + ":" + code;
}

}  // namespace

Result<CrsInfo> lookup_projected_crs(const std::string& code) {
  const ContextPtr context = make_context();
  RAYFIELD_ASSIGN(const PjPtr crs, open_projected(context.get(), code));
  CrsInfo info;
  info.code = code_of(context.get(), code);
  info.name = proj_get_name(crs.get());
  const char* wkt = proj_as_wkt(context.get(), crs.get(), PJ_WKT2_2019, nullptr);
  if (wkt != nullptr) info.wkt = wkt;
  return info;
}

struct MapFrame::Impl {
  ContextPtr context;
  PjPtr map_from_geodetic;  // input longitude, latitude in degrees; output easting, northing
  PjPtr crs_object;
  CrsInfo info;
};

Result<MapFrame> MapFrame::create(const std::string& code) {
  auto impl = std::make_shared<Impl>();
  RAYFIELD_ASSIGN(impl->info, lookup_projected_crs(code));
  impl->context = make_context();
  RAYFIELD_ASSIGN(impl->crs_object, open_projected(impl->context.get(), code));
  const PjPtr geographic(proj_crs_get_geodetic_crs(impl->context.get(), impl->crs_object.get()));
  if (!geographic) return bad_crs(code, "it has no geographic base");
  const PjPtr operation(
      proj_create_crs_to_crs_from_pj(impl->context.get(), geographic.get(), impl->crs_object.get(), nullptr, nullptr));
  if (!operation) return bad_crs(code, "PROJ finds no transformation from its geographic base");
  impl->map_from_geodetic.reset(proj_normalize_for_visualization(impl->context.get(), operation.get()));
  if (!impl->map_from_geodetic) return bad_crs(code, "PROJ cannot normalise its axis order");
  MapFrame frame;
  frame.impl_ = std::move(impl);
  return frame;
}

Eigen::Vector3d MapFrame::map_from_geodetic(const Eigen::Vector3d& llh) const {
  const PJ_COORD out = proj_trans(impl_->map_from_geodetic.get(), PJ_FWD, proj_coord(llh.y(), llh.x(), llh.z(), 0));
  return {out.xyz.x, out.xyz.y, llh.z()};
}

Eigen::Vector3d MapFrame::geodetic_from_map(const Eigen::Vector3d& p) const {
  const PJ_COORD out = proj_trans(impl_->map_from_geodetic.get(), PJ_INV, proj_coord(p.x(), p.y(), p.z(), 0));
  return {out.xyz.y, out.xyz.x, p.z()};
}

double MapFrame::convergence_rad(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d llh = geodetic_from_map(p);
  const double step_deg = 1e-4;
  const Eigen::Vector3d north = map_from_geodetic(llh + Eigen::Vector3d(step_deg, 0, 0));
  const Eigen::Vector3d south = map_from_geodetic(llh - Eigen::Vector3d(step_deg, 0, 0));
  // True north as seen on the grid points at atan2(dE, dN); grid north lies at minus that from true north.
  return -std::atan2(north.x() - south.x(), north.y() - south.y());
}

double MapFrame::scale_factor(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d llh = geodetic_from_map(p);
  const TangentPlane plane({llh.x(), llh.y(), 0});
  const Eigen::Matrix3d j = map_from_enu_jacobian(*this, plane, Eigen::Vector3d::Zero());
  return std::sqrt(std::abs(j.topLeftCorner<2, 2>().determinant()));
}

const CrsInfo& MapFrame::crs() const { return impl_->info; }

std::string utm_code(double latitude_deg, double longitude_deg) {
  if (!(latitude_deg >= -80 && latitude_deg <= 84) || !std::isfinite(longitude_deg)) return {};
  const double east_of_antimeridian = longitude_deg + 180 - 360 * std::floor((longitude_deg + 180) / 360);
  const int zone = std::min(60, 1 + static_cast<int>(east_of_antimeridian / 6));
  return fmt::format("EPSG:{}", (latitude_deg < 0 ? 32700 : 32600) + zone);
}

bool same_crs(const std::string& a, const std::string& b) {
  if (a == b) return true;
  const ContextPtr context = make_context();
  const auto first = open_projected(context.get(), a), second = open_projected(context.get(), b);
  if (!first || !second) return false;
  return code_of(context.get(), a) == code_of(context.get(), b) ||
         proj_is_equivalent_to(first->get(), second->get(), PJ_COMP_EQUIVALENT) != 0;
}

Result<void> check_crs_scale(const std::string& code) {
  constexpr int kSteps = 9;
  RAYFIELD_ASSIGN(const MapFrame frame, MapFrame::create(code));
  const ContextPtr context = make_context();
  RAYFIELD_ASSIGN(const PjPtr crs, open_projected(context.get(), code));
  const auto area = area_of(context.get(), crs.get());
  if (!area) return {};
  const double width_deg = area->east_deg - area->west_deg + (area->east_deg < area->west_deg ? 360 : 0);
  int off = 0;
  double worst = 1;
  for (int i = 0; i < kSteps * kSteps; ++i) {
    const int line = i / kSteps, column = i % kSteps;
    const double north = (0.5 + line) / kSteps, east = (0.5 + column) / kSteps;
    const Eigen::Vector3d p = frame.map_from_geodetic(
        {area->south_deg + north * (area->north_deg - area->south_deg), area->west_deg + east * width_deg, 0});
    const double scale = frame.scale_factor(p);
    if (std::abs(scale - 1) <= kScaleTolerance) continue;
    ++off;
    if (std::isfinite(scale) && std::abs(scale - 1) > std::abs(worst - 1)) worst = scale;
  }
  if (2 * off <= kSteps * kSteps) return {};
  return bad_crs(frame.crs().code,
                 fmt::format("in most of the area that it is made for a metre is not a metre on its grid (up to {:.3f} "
                             "m), so areas would be wrong",
                             worst));
}

Result<void> check_crs_suits(const std::string& code, const Eigen::Vector3d& llh) {
  RAYFIELD_ASSIGN(const MapFrame frame, MapFrame::create(code));
  const Eigen::Vector3d p = frame.map_from_geodetic(llh);
  const double scale = p.allFinite() ? frame.scale_factor(p) : std::numeric_limits<double>::quiet_NaN();
  // On the far side of the Earth a transverse Mercator is true to scale again, upside down.
  const double turned_deg = std::isfinite(scale) ? std::abs(frame.convergence_rad(p)) * 180 / std::numbers::pi : 0;
  if (std::abs(scale - 1) <= kScaleTolerance && turned_deg <= kMaxConvergence_deg) return {};
  const std::string place = fmt::format("latitude {:.4f}, longitude {:.4f}", llh.x(), llh.y());
  const std::string utm = utm_code(llh.x(), llh.y());
  std::string why = fmt::format("it has no coordinates for {}", place);
  if (std::isfinite(scale))
    why = fmt::format("at {} a metre is {:.3f} m on its grid, so areas would be wrong", place, scale);
  if (turned_deg > kMaxConvergence_deg)
    why = fmt::format("at {} its grid north is {:.0f}° off true north: it is made for another part of the Earth", place,
                      turned_deg);
  return fail(ErrorCode::usage, "cannot use coordinate reference system", code, why,
              "give a CRS made for that place" + (utm.empty() ? utm : ", e.g. " + utm));
}

Result<std::optional<std::string>> check_map_place(const std::string& code, const Eigen::Vector3d& p) {
  RAYFIELD_ASSIGN(const MapFrame frame, MapFrame::create(code));
  const Eigen::Vector3d llh = frame.geodetic_from_map(p);
  const std::string point = fmt::format("easting {:.1f}, northing {:.1f}", p.x(), p.y());
  constexpr std::string_view kNext = "check whether they are in degrees, in feet, in a local frame or in another CRS";
  if (!llh.allFinite())
    return fail(ErrorCode::usage, "cannot use coordinates", point, "no place on Earth has them in " + code, kNext);
  const ContextPtr context = make_context();
  RAYFIELD_ASSIGN(const PjPtr crs, open_projected(context.get(), code));
  const auto area = area_of(context.get(), crs.get());
  const double outside_deg = area ? area->distance_deg(llh.x(), llh.y()) : 0;
  const std::string place =
      fmt::format("latitude {:.4f}, longitude {:.4f}, {:.1f}° outside of the area that it is made for", llh.x(),
                  llh.y(), outside_deg);
  // UTM's own origin lies on the equator beside the zone: who is there has degrees, or metres of his own.
  const bool at_origin = outside_deg > 0 && p.head<2>().norm() < kNearOrigin_m;
  if (outside_deg > kMaxOutside_deg || at_origin)
    return fail(ErrorCode::usage, "cannot use coordinates", point, fmt::format("in {} that is {}", code, place), kNext);
  RAYFIELD_CHECK(check_crs_suits(code, llh));
  if (outside_deg == 0) return std::optional<std::string>();
  return std::optional(fmt::format("{} in {} is {}: check the CRS", point, code, place));
}

struct TangentPlane::Impl {
  GeographicLib::LocalCartesian plane;
};

TangentPlane::TangentPlane(const Eigen::Vector3d& llh)
    : origin_(llh), impl_(std::make_shared<Impl>(Impl{GeographicLib::LocalCartesian(llh.x(), llh.y(), llh.z())})) {}

Eigen::Vector3d TangentPlane::enu_from_geodetic(const Eigen::Vector3d& llh) const {
  Eigen::Vector3d p;
  impl_->plane.Forward(llh.x(), llh.y(), llh.z(), p.x(), p.y(), p.z());
  return p;
}

Eigen::Vector3d TangentPlane::geodetic_from_enu(const Eigen::Vector3d& p) const {
  Eigen::Vector3d llh;
  impl_->plane.Reverse(p.x(), p.y(), p.z(), llh.x(), llh.y(), llh.z());
  return llh;
}

Eigen::Matrix3d map_from_enu_jacobian(const MapFrame& frame, const TangentPlane& plane, const Eigen::Vector3d& p) {
  constexpr double kStep = 50.0;
  Eigen::Matrix3d j;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
    j.col(axis) = (frame.map_from_geodetic(plane.geodetic_from_enu(p + step)) -
                   frame.map_from_geodetic(plane.geodetic_from_enu(p - step))) /
                  (2 * kStep);
  }
  return j;
}

}  // namespace rayfield
