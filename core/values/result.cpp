#include "rayfield/core/result.h"

#include <cerrno>
#include <cstring>

namespace rayfield {

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
  ErrorCode code = ErrorCode::bad_input;
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
    case EACCES:
    case EROFS:
    case EPERM:
    case ENOMEM:
    case EMFILE:
    case ENFILE:
    case EFBIG:
      code = ErrorCode::resources;
      break;
    default:
      break;
  }
  if (next.empty() && (error_number == ENOSPC || error_number == EDQUOT))
    next = "free some disk space and run the same command again";
  return fail(code, what, where, std::strerror(error_number), next);
}

}  // namespace rayfield
