#pragma once

/// Fault injection for the crash tests (tests/fault). Every system call on which the durability of the store depends
/// asks here first. Only builds with RAYFIELD_FAULT_POINTS have it, which are those with tests; in others nobody who
/// sets the environment of a rayfield can make it die.
///
///   RAYFIELD_FAULT="name:n[:kill|:enospc]"   at the n-th (from 1) passage of `name`: SIGKILL (default) or ENOSPC
///   RAYFIELD_FAULT="*:n:…"                   at the n-th passage of any point
namespace rayfield::tile::fault {

/// 0, or the errno with which the call after this point shall fail. Does not return where the process shall die.
#ifdef RAYFIELD_FAULT_POINTS
int point(const char* name);
#else
constexpr int point(const char* /*name*/) { return 0; }
#endif

}  // namespace rayfield::tile::fault
