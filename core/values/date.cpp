#include "rayfield/core/date.h"

#include <fmt/core.h>

#include <cmath>

namespace rayfield {

namespace {

constexpr int kFirstYear = 1960, kLastYear = 2999;

}  // namespace

Result<std::string> parse_date(std::string_view text) {
  RAYFIELD_CHECK(parse_calendar_day(text));
  return std::string(text);
}

Result<std::chrono::year_month_day> parse_calendar_day(std::string_view text) {
  const auto bad = [&text](std::string_view why) {
    return fail(ErrorCode::usage, "bad date", text, why, "give a date as YYYY-MM-DD, e.g. 2019-02-11");
  };
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return bad("not of the form YYYY-MM-DD");
  int part[3] = {0, 0, 0};
  const std::size_t begin[3] = {0, 5, 8}, length[3] = {4, 2, 2};
  for (int i = 0; i < 3; ++i) {
    for (const char c : text.substr(begin[i], length[i])) {
      if (c < '0' || c > '9') return bad("not of the form YYYY-MM-DD");
      part[i] = part[i] * 10 + (c - '0');
    }
  }
  const std::chrono::year_month_day day{std::chrono::year{part[0]}, std::chrono::month{static_cast<unsigned>(part[1])},
                                        std::chrono::day{static_cast<unsigned>(part[2])}};
  if (!day.ok()) return bad("no such day in the calendar");
  if (part[0] < kFirstYear || part[0] > kLastYear) return bad("no year in which a lidar could have measured");
  return day;
}

std::string utc_text(double unix_time_s) {
  if (!std::isfinite(unix_time_s) || std::abs(unix_time_s) > 2.5e11) return "invalid time";
  const auto total_ms = static_cast<std::int64_t>(std::llround(unix_time_s * 1000.0));
  const std::chrono::sys_time<std::chrono::milliseconds> when{std::chrono::milliseconds{total_ms}};
  const auto day = std::chrono::floor<std::chrono::days>(when);
  const std::chrono::year_month_day date{day};
  const std::chrono::hh_mm_ss clock{when - day};
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), clock.hours().count(),
                     clock.minutes().count(), clock.seconds().count(), clock.subseconds().count());
}

}  // namespace rayfield
