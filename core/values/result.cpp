#include "rayfield/core/result.h"

#include <cerrno>
#include <cstring>

namespace rayfield {
namespace {

ErrorCode code_of_errno(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
    case EACCES:
    case EPERM:
    case EROFS:
    case ENOMEM:
    case EMFILE:
    case ENFILE:
    case ENOLCK:
    // The device, or the way to it: the same input may be read once it is back.
    case EIO:
    case EREMOTEIO:
    case ENODEV:
    case ENXIO:
    case ESTALE:
    case ETIMEDOUT:
    case EHOSTDOWN:
    case ENOTCONN:
      return ErrorCode::resources;
    default:
      return ErrorCode::bad_input;
  }
}

}  // namespace

std::string Error::line() const {
  std::string text = what;
  const auto append = [&text](std::string_view separator, const std::string& part) {
    if (part.empty()) return;
    if (!text.empty()) text += separator;
    text += part;
  };
  append(": ", where);
  append(": ", why);
  append("; ", next);
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return text;
}

tl::unexpected<Error> fail(ErrorCode code, std::string_view what, std::string_view where, std::string_view why,
                           std::string_view next) {
  return tl::make_unexpected(Error{code, std::string(what), std::string(where), std::string(why), std::string(next)});
}

tl::unexpected<Error> fail_errno(int error_number, std::string_view what, std::string_view where,
                                 std::string_view next) {
  if (next.empty() && (error_number == ENOSPC || error_number == EDQUOT))
    next = "free some disk space and run the same command again";
  if (next.empty() && error_number == EIO) next = "check the disk and run the same command again";
  return fail(code_of_errno(error_number), what, where, std::strerror(error_number), next);
}

tl::unexpected<Error> fail_output(int error_number, std::string_view what, std::string_view where,
                                  std::string_view next) {
  if (next.empty() && code_of_errno(error_number) == ErrorCode::bad_input) next = "give another place";
  Error error = fail_errno(error_number, what, where, next).value();
  error.code = ErrorCode::resources;
  return tl::make_unexpected(std::move(error));
}

}  // namespace rayfield
