#pragma once

#include <span>
#include <string>

#include "rayfield/core/result.h"

namespace rayfield::cli {

/// A file that a command is asked to write.
struct OutputPath {
  std::string option;  ///< "--trajectory"
  std::string what;    ///< "cannot write trajectory"
  std::string path;
};

/// Checks before hours of work what would make writing fail after them: that each path names a file in a folder that
/// can be written to, is not there already (unless `overwrite`), and is neither one of `inputs` nor given twice.
/// Errors: usage, resources (no permission, no space for a file).
Result<void> check_outputs(std::span<const OutputPath> outputs, std::span<const std::string> inputs, bool overwrite);

}  // namespace rayfield::cli
