#pragma once

#include <string>

#include "rayfield/formats/log_info.h"

namespace rayfield::formats {

/// A rig file for a log: its topics, ranges and no-return convention filled in, the mounting (which is in no log) as
/// comments that have to be completed before the file is accepted.
std::string propose_rig(const LogInfo& info);

}  // namespace rayfield::formats
