#pragma once

#include "cli/console/common_options.h"

/// commands: those of `rayfield` (docs/commands.md), one file each: what it takes, which job it does, what it says.
namespace rayfield::cli {

/// Each declares one command with its options and its work.
void add_demo_command(Commands& commands);
void add_simulate_command(Commands& commands);
void add_slam_command(Commands& commands);
void add_init_command(Commands& commands);
void add_add_command(Commands& commands);
void add_process_command(Commands& commands);
void add_export_command(Commands& commands);
void add_compare_command(Commands& commands);
void add_report_command(Commands& commands);
void add_zones_command(Commands& commands);
void add_update_command(Commands& commands);
void add_remove_command(Commands& commands);
void add_revert_command(Commands& commands);
void add_verify_command(Commands& commands);
void add_repair_command(Commands& commands);
void add_status_command(Commands& commands);
void add_log_command(Commands& commands);
void add_gc_command(Commands& commands);
void add_info_command(Commands& commands);
void add_registry_command(Commands& commands);
void add_options_command(Commands& commands);
void add_experiment_command(Commands& commands);
void add_help_command(Commands& commands);
void add_completion_command(Commands& commands);

/// What a store holds: `status`, and `info` of a store.
Result<Outcome> store_status(const std::string& folder);

/// Declares all of them, in the order of `rayfield --help`.
void add_all_commands(Commands& commands);

}  // namespace rayfield::cli
