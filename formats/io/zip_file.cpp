#include "formats/io/zip_file.h"

#include <minizip/zip.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>

#include "formats/io/staged_output.h"
#include "rayfield/core/date.h"

namespace rayfield::formats {
namespace {

constexpr std::string_view kNext = "check that the folder is writable and has space";

zip_fileinfo stamped(const std::string& date) {
  zip_fileinfo info = {};
  info.tmz_date.tm_year = 1980, info.tmz_date.tm_mon = 0, info.tmz_date.tm_mday = 1;
  if (const auto day = parse_calendar_day(date)) {
    info.tmz_date.tm_year = static_cast<uInt>(std::clamp(static_cast<int>(day->year()), 1980, 2107));
    info.tmz_date.tm_mon = static_cast<unsigned>(day->month()) - 1;
    info.tmz_date.tm_mday = static_cast<unsigned>(day->day());
  }
  return info;
}

bool add_member(zipFile zip, const ZipMember& member, const zip_fileinfo& info) {
  if (zipOpenNewFileInZip(zip, member.name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED, 6) != ZIP_OK)
    return false;
  const bool written =
      zipWriteInFileInZip(zip, member.bytes.data(), static_cast<unsigned>(member.bytes.size())) == ZIP_OK;
  return zipCloseFileInZip(zip) == ZIP_OK && written;
}

}  // namespace

Result<void> write_zip(std::span<const ZipMember> members, const std::string& date, const std::string& path,
                       std::string_view what) {
  RAYFIELD_ASSIGN(const StagedOutput staged, StagedOutput::create(path, what));
  const zip_fileinfo info = stamped(date);
  errno = 0;
  zipFile zip = zipOpen(staged.path("archive").c_str(), APPEND_STATUS_CREATE);
  bool good = zip != nullptr;
  for (const ZipMember& member : members) good = good && add_member(zip, member, info);
  if (zip != nullptr && zipClose(zip, nullptr) != ZIP_OK) good = false;
  if (!good) return fail_errno(errno != 0 ? errno : ENOSPC, what, path, kNext);
  return staged.publish("archive");
}

}  // namespace rayfield::formats
