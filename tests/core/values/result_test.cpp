#include "rayfield/core/result.h"

#include <gtest/gtest.h>

#include <cerrno>

namespace rayfield {
namespace {

TEST(Error, IsOneLineWithWhatWhereWhyAndWhatNext) {
  const Error error{ErrorCode::bad_input, "cannot read", "a.ply", "it is empty", "give another"};
  EXPECT_EQ(error.line(), "cannot read: a.ply: it is empty; give another");
}

TEST(Error, LeavesOutEmptyPartsWithoutStrayPunctuation) {
  EXPECT_EQ((Error{ErrorCode::internal, "x", "", "y", ""}.line()), "x: y");
  EXPECT_EQ((Error{ErrorCode::internal, "", "", "y", ""}.line()), "y");
}

TEST(Error, NeverBreaksTheLineEvenForHostileNames) {
  const Error error{ErrorCode::bad_input, "cannot read", "a\nb\x1b[31m.ply", "", ""};
  EXPECT_EQ(error.line().find('\n'), std::string::npos);
  EXPECT_EQ(error.line().find('\x1b'), std::string::npos);
}

TEST(FailErrno, CallsDiskAndPermissionProblemsResources) {
  for (const int number : {ENOSPC, EACCES, EROFS, EDQUOT, ENOMEM, EIO, ESTALE, ENODEV})
    EXPECT_EQ(fail_errno(number, "w", "p").value().code, ErrorCode::resources);
  EXPECT_EQ(fail_errno(ENOENT, "w", "p").value().code, ErrorCode::bad_input);
  // Of an output nothing is bad input.
  for (const int number : {ENOENT, ENOTDIR, EINVAL, ENOSPC})
    EXPECT_EQ(fail_output(number, "w", "p").value().code, ErrorCode::resources);
  EXPECT_FALSE(fail_output(ENOENT, "w", "p").value().next.empty());
}

Result<int> half(int x) {
  if (x % 2 != 0) return fail(ErrorCode::usage, "odd", "", "");
  return x / 2;
}
Result<int> quarter(int x) {
  RAYFIELD_ASSIGN(const int h, half(x));
  return half(h);
}

TEST(ResultMacros, PassValuesOnAndReturnErrors) {
  EXPECT_EQ(quarter(8).value(), 2);
  EXPECT_EQ(quarter(6).error().code, ErrorCode::usage);
  EXPECT_EQ(quarter(3).error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield
