#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

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

/// The failure of a system call, from `errno` as given: ENOSPC, EDQUOT, EACCES, EROFS, EPERM, ENOMEM become
/// `resources`, the rest `bad_input`.
tl::unexpected<Error> fail_errno(int error_number, std::string_view what, std::string_view where,
                                 std::string_view next = {});

}  // namespace rayfield

/// Evaluates `expr` (a Result); returns its error from the enclosing function or moves its value into `lhs`.
#define RAYFIELD_CONCAT_INNER(a, b) a##b
#define RAYFIELD_CONCAT(a, b) RAYFIELD_CONCAT_INNER(a, b)
#define RAYFIELD_ASSIGN(lhs, expr)                                                              \
  auto RAYFIELD_CONCAT(rayfield_result_, __LINE__) = (expr);                                    \
  if (!RAYFIELD_CONCAT(rayfield_result_, __LINE__))                                             \
    return tl::make_unexpected(std::move(RAYFIELD_CONCAT(rayfield_result_, __LINE__)).error()); \
  lhs = std::move(*RAYFIELD_CONCAT(rayfield_result_, __LINE__))
/// Evaluates `expr` (a Result<void>) and returns its error from the enclosing function.
#define RAYFIELD_CHECK(expr)                                                                          \
  do {                                                                                                \
    auto rayfield_check_result = (expr);                                                              \
    if (!rayfield_check_result) return tl::make_unexpected(std::move(rayfield_check_result).error()); \
  } while (false)
