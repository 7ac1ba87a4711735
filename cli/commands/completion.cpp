#include "cli/console/completion.h"

#include <memory>

#include "cli/commands/commands.h"
#include "cli/console/command_table.h"

namespace rayfield::cli {
namespace {

Result<Outcome> run_completion(const CLI::App& app, const std::string& shell) {
  const std::vector<CommandEntry> commands = command_table(app);
  if (shell == "bash") return Outcome{{}, bash_completion(commands)};
  return Outcome{{}, shell == "zsh" ? zsh_completion(commands) : fish_completion(commands)};
}

}  // namespace

void add_completion_command(Commands& commands) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* command = commands.add_plain(
      "completion", "Print what makes a shell complete commands and options", "source <(rayfield completion bash)",
      [shell, &app = commands.app()](Context&) { return run_completion(app, *shell); });
  command->add_option("SHELL", *shell, "The shell that it is for")
      ->required()
      ->transform(CLI::IsMember({"bash", "zsh", "fish"}, CLI::ignore_case));
}

}  // namespace rayfield::cli
