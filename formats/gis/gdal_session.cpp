#include "formats/gis/gdal_session.h"

#include <cpl_conv.h>

#include <array>
#include <mutex>

namespace rayfield::formats {
namespace {

/// GDAL's default cache is 5 % of the machine's memory, which would escape `--memory`.
constexpr GIntBig kBlockCacheBytes = 64 << 20;

void register_once() {
  static std::once_flag once;
  std::call_once(once, [] {
    if (CPLGetConfigOption("GDAL_CACHEMAX", nullptr) == nullptr) GDALSetCacheMax64(kBlockCacheBytes);
    GDALAllRegister();
  });
}

// PROJ could not open or read proj.db, which says nothing about what it was asked for.
bool about_proj_database(std::string_view message) {
  return message.find("proj.db") != std::string_view::npos ||
         (message.find("PROJ") != std::string_view::npos && message.find("SQLite error") != std::string_view::npos);
}

bool about_resources(CPLErrorNum number, std::string_view message) {
  if (number == CPLE_FileIO || number == CPLE_OutOfMemory || number == CPLE_NoWriteAccess) return true;
  constexpr std::array<std::string_view, 12> kSigns = {
      "No space left",         "disk is full", "File too large",     "Permission denied",
      "Read-only file system", "readonly",     "disk I/O error",     "disk image is malformed",
      "Write error",           "Disk quota",   "Input/output error", "Stale file handle"};
  for (const std::string_view sign : kSigns) {
    if (message.find(sign) != std::string_view::npos) return true;
  }
  return false;
}

}  // namespace

GdalSession::GdalSession(std::vector<std::pair<std::string, std::string>> options) {
  register_once();
  options.insert(options.begin(), {{"GDAL_PAM_ENABLED", "NO"}, {"GDAL_NUM_THREADS", "1"}});
  for (const auto& [key, value] : options) {
    const char* previous = CPLGetThreadLocalConfigOption(key.c_str(), nullptr);
    saved_.emplace_back(key, previous == nullptr ? "" : previous);
    CPLSetThreadLocalConfigOption(key.c_str(), value.c_str());
  }
  CPLPushErrorHandlerEx(on_error, this);
}

GdalSession::~GdalSession() {
  CPLPopErrorHandler();
  CPLErrorReset();
  for (const auto& [key, value] : saved_) {
    CPLSetThreadLocalConfigOption(key.c_str(), value.empty() ? nullptr : value.c_str());
  }
}

void CPL_STDCALL GdalSession::on_error(CPLErr severity, CPLErrorNum number, const char* message) {
  auto* session = static_cast<GdalSession*>(CPLGetErrorHandlerUserData());
  if (severity < CE_Failure || session == nullptr || session->failed()) return;
  session->message_ = message == nullptr || *message == '\0' ? "GDAL reported a failure" : message;
  session->number_ = number;
}

tl::unexpected<Error> crs_failure(std::string_view what, std::string_view where, std::string_view why,
                                  std::string_view next) {
  if (!about_proj_database(CPLGetLastErrorMsg())) return fail(ErrorCode::usage, what, where, why, next);
  return fail(ErrorCode::resources, what, where, "PROJ cannot read its database, proj.db",
              "check that the package proj-data is installed, and that files can be opened (ulimit -n) and read");
}

tl::unexpected<Error> GdalSession::failure(std::string_view what, std::string_view where) const {
  if (failed() && about_proj_database(message_))
    return fail(ErrorCode::resources, what, where, "PROJ cannot read its database, proj.db",
                "check that files can be opened (ulimit -n) and read");
  if (failed() && about_resources(number_, message_)) {
    return fail(ErrorCode::resources, what, where, message_, "check space and permissions of the folder");
  }
  return fail(ErrorCode::internal, what, where, failed() ? message_ : "GDAL failed without a reason");
}

Result<OGRSpatialReference> parse_crs(const std::string& crs, std::string_view what, std::string_view where) {
  OGRSpatialReference reference;
  reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  CPLErrorReset();
  if (crs.empty() || reference.SetFromUserInput(
                         crs.c_str(), OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) != OGRERR_NONE) {
    return crs_failure(what, where, "unknown coordinate reference system '" + crs + "'",
                       "give a projected CRS such as EPSG:7854");
  }
  return reference;
}

}  // namespace rayfield::formats
