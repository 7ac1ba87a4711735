#pragma once

#include <string>
#include <string_view>

namespace rayfield::formats {

/// Text from users made safe to store: invalid UTF-8 becomes U+FFFD, control characters a space.
std::string clean_text(std::string_view text);

/// For XML text and attribute values in double quotes; also cleans.
std::string xml_escape(std::string_view text);

/// One CSV field after RFC 4180: quoted where it holds a comma, a quote or a line break; also cleans.
std::string csv_escape(std::string_view text);

/// A JSON string, quotes included.
std::string json_string(std::string_view text);

/// The shortest text that reads back as the same double; `undefined` for NaN and infinities.
std::string number_text(double value, std::string_view undefined);

/// An SQL string literal, quotes included.
std::string sql_literal(std::string_view text);

}  // namespace rayfield::formats
