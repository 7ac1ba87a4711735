#pragma once

#include <span>

#include "libdensity/layout/row_layout.h"

namespace rayfield::density {

/// Median distance of neighbouring rows of one block, rows in the order of their numbers; NaN for a single row.
double row_spacing(std::span<const Row> rows);

/// Orients, orders and numbers rows, and sets the spacing. Deterministic for any order of the input.
void number_rows(RowLayout& layout);

}  // namespace rayfield::density
