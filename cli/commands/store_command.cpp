#include "cli/commands/store_command.h"

#include <memory>
#include <utility>

namespace rayfield::cli {

CLI::App* add_store_command(Commands& commands, const std::string& name, const std::string& description,
                            std::function<Result<Outcome>(const std::string&, Context&)> run,
                            const std::string& example) {
  const auto folder = std::make_shared<std::string>();
  CLI::App* command = commands.add(name, description, example.empty() ? "rayfield " + name + " myblock" : example,
                                   [folder, run = std::move(run)](Context& context) { return run(*folder, context); });
  command->add_option("STORE", *folder, "Folder of the store")->required();
  return command;
}

}  // namespace rayfield::cli
