#pragma once

#include "libdensity/layout/row_layout.h"
#include "rayfield/core/result.h"
#include "rayfield/core/surveyed_block.h"

namespace rayfield::density {

/// Rows and posts of a survey as a layout without panels and trunks. Lines are the rows' centrelines; a row that is
/// given by its posts alone runs through them, from the first to the last. Posts belong to the row of their number or
/// name, else to the nearest line within 1 m. They have detected = false: no scan has shown them yet, their diameter is
/// a default unless the survey has it. Rows are ordered, turned and numbered as found ones are (rows.h); the survey's
/// numbers and names are the farm's.
/// Errors: bad_input, naming what does not do: no rows, a row of one post, a post that belongs to no row, two rows of
/// one number or name, rows on top of each other.
Result<RowLayout> layout_of_survey(const SurveyedBlock& survey);

}  // namespace rayfield::density
