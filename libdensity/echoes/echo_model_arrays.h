#pragma once

#include <optional>
#include <vector>

#include "libdensity/echoes/echo_model.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

inline constexpr const char* kEchoModelKind = "echoes";

/// Stored form: column "model" of the model's numbers, empty where the echoes do not tell.
tile::ArraySet arrays_from_echo_model(const std::optional<EchoModel>& model);

/// Errors: damaged, where there is another number of them, one that is not finite or negative, or no full echo.
Result<std::optional<EchoModel>> echo_model_from_arrays(const tile::ArraySet& arrays);

/// Everything in it, for keys.
std::vector<double> model_numbers(const std::optional<EchoModel>& model);

}  // namespace rayfield::density
