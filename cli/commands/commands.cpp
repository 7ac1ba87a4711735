#include "cli/commands/commands.h"

namespace rayfield::cli {

void add_all_commands(Commands& commands) {
  add_demo_command(commands);
  add_simulate_command(commands);
  add_slam_command(commands);
  add_init_command(commands);
  add_add_command(commands);
  add_process_command(commands);
  add_export_command(commands);
  add_update_command(commands);
  add_compare_command(commands);
  add_report_command(commands);
  add_zones_command(commands);
  add_registry_command(commands);
  add_info_command(commands);
  add_options_command(commands);
  add_experiment_command(commands);
  add_status_command(commands);
  add_log_command(commands);
  add_remove_command(commands);
  add_revert_command(commands);
  add_verify_command(commands);
  add_repair_command(commands);
  add_gc_command(commands);
  add_help_command(commands);
  add_completion_command(commands);
}

}  // namespace rayfield::cli
