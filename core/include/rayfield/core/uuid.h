#pragma once

#include <string>
#include <string_view>

namespace rayfield {

/// Name-based UUID (RFC 4122 layout, version 8: SHA-256 of `space` NUL `name`): the same names give the same UUID on
/// every machine. Lower-case text form with hyphens.
std::string named_uuid(std::string_view space, std::string_view name);

}  // namespace rayfield
