#pragma once

#include <filesystem>

#include "rayfield/core/file.h"

namespace rayfield {

/// A file in a folder, for reading and writing, that is gone when it is closed. It has no name where the file system
/// can do that, so that nothing is left of it by a process that is killed or a disk that fails. Not valid: errno says
/// why.
FileDescriptor make_nameless_file(const std::filesystem::path& folder);

}  // namespace rayfield
