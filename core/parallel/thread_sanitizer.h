#pragma once

/// GCC's OpenMP runtime is not built with ThreadSanitizer, which therefore does not see that a team starts after what
/// was written before its region, and ends before what follows it: every region would look like a race. These marks
/// tell it. They cost nothing in other builds.
#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#define RAYFIELD_NO_TSAN __attribute__((noinline, no_sanitize("thread")))
#else
#define RAYFIELD_NO_TSAN
#endif

namespace rayfield::tsan {

#if defined(__SANITIZE_THREAD__)
// Of the whole process and not of one region: the marks come before anything of the region is read.
inline char fork_mark = 0, join_mark = 0;

__attribute__((noinline)) inline void before_fork() { __tsan_release(&fork_mark); }
__attribute__((noinline)) inline void after_fork() { __tsan_acquire(&fork_mark); }
__attribute__((noinline)) inline void before_join() { __tsan_release(&join_mark); }
__attribute__((noinline)) inline void after_join() { __tsan_acquire(&join_mark); }
#else
inline void before_fork() {}
inline void after_fork() {}
inline void before_join() {}
inline void after_join() {}
#endif

}  // namespace rayfield::tsan
