#pragma once

#include "cli/console/common_options.h"

namespace rayfield::cli {

/// One function per command of docs/commands.md; each declares its options and its work.
void add_demo_verb(Commands& commands);
void add_simulate_verb(Commands& commands);
void add_slam_verb(Commands& commands);
void add_init_verb(Commands& commands);
void add_add_verb(Commands& commands);
void add_process_verb(Commands& commands);
void add_export_verb(Commands& commands);
void add_verify_verb(Commands& commands);
void add_status_verb(Commands& commands);
void add_log_verb(Commands& commands);
void add_gc_verb(Commands& commands);
void add_info_verb(Commands& commands);

/// What a store holds: `status`, and `info` of a store.
Result<Outcome> store_status(const std::string& folder);

inline void add_all_verbs(Commands& commands) {
  add_demo_verb(commands);
  add_simulate_verb(commands);
  add_slam_verb(commands);
  add_init_verb(commands);
  add_add_verb(commands);
  add_process_verb(commands);
  add_export_verb(commands);
  add_info_verb(commands);
  add_status_verb(commands);
  add_log_verb(commands);
  add_verify_verb(commands);
  add_gc_verb(commands);
}

}  // namespace rayfield::cli
