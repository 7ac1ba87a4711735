#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "rayfield/core/result.h"

namespace rayfield {

/// Checks a calendar date `YYYY-MM-DD` (ISO 8601) and returns it. Errors: usage.
Result<std::string> parse_date(std::string_view text);

/// The same as year, month and day.
Result<std::chrono::year_month_day> parse_calendar_day(std::string_view text);

/// Unix time (s) as ISO 8601 UTC with milliseconds, `2019-02-11T00:01:54.770Z`.
std::string utc_text(double unix_time_s);

}  // namespace rayfield
