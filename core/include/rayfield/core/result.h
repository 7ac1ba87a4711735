#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
/// values: what everything else is made of: errors as values, dates, grids, poses, rays, products.
namespace rayfield {

/// What kind of failure; the value is the exit code of the command line (docs/commands.md).
enum class ErrorCode : int {
  internal = 1,      ///< a defect in rayfield
  usage = 2,         ///< wrong usage or configuration
  bad_input = 3,     ///< bad or unreadable input
  damaged = 4,       ///< the store is damaged
  resources = 5,     ///< out of disk, memory or permission
  locked = 6,        ///< another writer holds the store
  interrupted = 130  ///< stopped by the user
};

/// A recoverable failure as a value. Printed as one line: `what: where: why; next`.
struct Error {
  ErrorCode code = ErrorCode::internal;
  std::string what;   ///< what could not be done ("cannot read ray cloud")
  std::string where;  ///< path, with offset, row or message number where known
  std::string why;    ///< the reason
  std::string next;   ///< what the user can do about it

  /// The four parts on one line; control characters in them are replaced by '?'.
  std::string line() const;
};

template <class T>
using Result = tl::expected<T, Error>;

/// `return fail(ErrorCode::bad_input, "cannot read ray cloud", path, "not a PLY file", "give ...");`
tl::unexpected<Error> fail(ErrorCode code, std::string_view what, std::string_view where, std::string_view why,
                           std::string_view next = {});

/// The failure of a system call: no space, no permission, no memory, EIO or a lost disk become `resources`, everything
/// else `bad_input`. This is the only place where `errno` is interpreted.
tl::unexpected<Error> fail_errno(int error_number, std::string_view what, std::string_view where,
                                 std::string_view next = {});

/// The failure of a system call that was to make an output: as fail_errno(), but nothing of it is `bad_input`: a place
/// where nothing can be made is `resources`, too.
tl::unexpected<Error> fail_output(int error_number, std::string_view what, std::string_view where,
                                  std::string_view next = {});

}  // namespace rayfield

/// Evaluates `expr` (a Result); returns its error from the enclosing function or moves its value into `lhs`.
/// Names are numbered by __COUNTER__, so that uses may nest in lambdas.
#define RAYFIELD_CONCAT_INNER(a, b) a##b
#define RAYFIELD_CONCAT(a, b) RAYFIELD_CONCAT_INNER(a, b)
#define RAYFIELD_ASSIGN_INNER(result, lhs, expr)                      \
  auto result = (expr);                                               \
  if (!result) return tl::make_unexpected(std::move(result).error()); \
  lhs = std::move(*result)
#define RAYFIELD_ASSIGN(lhs, expr) RAYFIELD_ASSIGN_INNER(RAYFIELD_CONCAT(rayfield_result_, __COUNTER__), lhs, expr)
/// Evaluates `expr` (a Result<void>) and returns its error from the enclosing function.
#define RAYFIELD_CHECK_INNER(result, expr)                              \
  do {                                                                  \
    auto result = (expr);                                               \
    if (!result) return tl::make_unexpected(std::move(result).error()); \
  } while (false)
#define RAYFIELD_CHECK(expr) RAYFIELD_CHECK_INNER(RAYFIELD_CONCAT(rayfield_check_, __COUNTER__), expr)
