#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "cli/console/config_file.h"
#include "cli/console/option_settings.h"
#include "tests/fuzz/memory_file.h"

/// Whatever the text of a configuration file: an error with its reason, or arguments that stand where options may
/// stand, and settings that can be parsed.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rayfield::cli;
  static const rayfield::fuzz::MemoryFile kFile;
  kFile.set(data, size);
  CLI::App app("rayfield");
  CLI::App* process = app.add_subcommand("process");
  std::vector<std::string> settings, dates;
  double length_m = 0;
  bool overwrite = false;
  add_settings_option(*process, settings);
  process->add_option("--panel-length", length_m);
  process->add_option("--date", dates);
  process->add_flag("--overwrite", overwrite);
  app.add_subcommand("gc");
  const auto expanded = expand_config(app, {"process", "store", "--config", kFile.path()});
  if (!expanded) {
    if (expanded.error().why.empty()) std::abort();
    return 0;
  }
  if (expanded->arguments.size() < 4 || expanded->arguments.front() != "process") std::abort();
  for (std::size_t i = 1; i + 3 < expanded->arguments.size(); ++i) {
    const std::string& argument = expanded->arguments[i];
    if (argument.rfind("--", 0) != 0) std::abort();
    if (argument.rfind("--set=", 0) == 0 && argument != "--set=") (void)parse_setting(argument.substr(6));
  }
  return 0;
}
