#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/console/command_table.h"
#include "cli/console/man_page.h"
#include "cli/console/output_paths.h"
#include "cli/console/suggestion.h"
#include "cli/console/usage_error.h"
#include "rayfield/formats/text_output.h"
#include "version.h"

namespace rayfield::cli {
namespace {

// The same text as `rayfield COMMAND --help`, or `rayfield --help`.
Result<Outcome> show_help(const CLI::App& app, const std::string& name) {
  if (name.empty())
    return Outcome{{}, app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal)};
  if (const CLI::App* command = find_command(app, name)) return Outcome{{}, command->help(app.get_name())};
  return fail(ErrorCode::usage, "no help", name, "no such command",
              suggestion(name, command_names(app), "", "`rayfield --help`"));
}

// rayfield.1, and rayfield-COMMAND.1 of every command.
Result<Outcome> write_manual(const CLI::App& app, const std::filesystem::path& folder) {
  constexpr const char* kWhat = "cannot write manual";
  RAYFIELD_ASSIGN(const OutputFolder made, OutputFolder::make(folder));
  const std::vector<CommandEntry> commands = command_table(app);
  const auto write = [&](const std::string& name, const std::string& page) {
    return formats::write_text_file((folder / (name + ".1")).string(), page, kWhat);
  };
  RAYFIELD_CHECK(write("rayfield", program_page(commands, kVersion, kDate)));
  for (const CommandEntry& command : commands)
    RAYFIELD_CHECK(write("rayfield-" + command.name, command_page(command, kVersion, kDate)));
  return Outcome{{}, fmt::format("{} pages in {}\n", commands.size() + 1, folder.string())};
}

}  // namespace

void add_help_command(Commands& commands) {
  const auto name = std::make_shared<std::string>(), folder = std::make_shared<std::string>();
  CLI::App* command = commands.add_plain("help", "Show what a command takes", "rayfield help process",
                                         [name, folder, &app = commands.app()](Context&) {
                                           return folder->empty() ? show_help(app, *name) : write_manual(app, *folder);
                                         });
  command->add_option("COMMAND", *name, "A command (default: the list of all)");
  command->add_option("--man", *folder, "Write the manual's pages of all commands into a folder")->type_name("FOLDER");
}

}  // namespace rayfield::cli
