#pragma once

#include <string>
#include <string_view>

#include "rayfield/core/result.h"

namespace rayfield::formats {

/// One bzip2 stream of a text. Errors: internal.
Result<std::string> pack_text(std::string_view text);

/// True for bytes that begin like a bzip2 stream.
bool is_packed(std::string_view bytes);

/// The text of a bzip2 stream. No text of numbers shrinks to less than a 64th: what claims to is refused, whatever
/// memory it asks for. Errors: bad_input with the reason in `why`.
Result<std::string> unpack_text(std::string_view bytes);

}  // namespace rayfield::formats
