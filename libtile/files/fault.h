#pragma once

/// Fault injection for the crash tests (tests/fault). Every system call on which the durability of the store depends
/// asks here first. Without RAYFIELD_FAULT in the environment a point costs one load and one branch.
///
///   RAYFIELD_FAULT="name:n[:kill|:enospc]"   at the n-th (from 1) passage of `name`: SIGKILL (default) or ENOSPC
///   RAYFIELD_FAULT="*:n:…"                   at the n-th passage of any point
namespace rayfield::tile::fault {

/// 0, or the errno with which the call after this point shall fail. Does not return where the process shall die.
int point(const char* name);

}  // namespace rayfield::tile::fault
