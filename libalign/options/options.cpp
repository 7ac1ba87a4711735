#include "rayfield/align/options.h"

namespace rayfield::align {

Result<void> AlignOptions::validate() const { return check_option_ranges(*this, "cannot use alignment option"); }

}  // namespace rayfield::align
