#pragma once

#include <map>
#include <string>

namespace rayfield::fuzz {

/// Small sound inputs of fuzz_derived, by name: one of each kind of derived data.
std::map<std::string, std::string> derived_seeds();

}  // namespace rayfield::fuzz
