#pragma once

#include <exception>
#include <new>
#include <string_view>

#include "rayfield/core/result.h"

namespace rayfield::formats {

/// Runs `body` (returning a Result) and turns exceptions into errors: no memory → resources, the rest → internal.
template <class Body>
auto guarded(std::string_view what, std::string_view where, const Body& body) -> decltype(body()) {
  try {
    return body();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::resources, what, where, "out of memory");
  } catch (const std::exception& error) {
    return fail(ErrorCode::internal, what, where, error.what());
  }
}

}  // namespace rayfield::formats
