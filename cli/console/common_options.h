#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/console/progress_reporter.h"
#include "rayfield/core/result.h"

/// console: what every command shares at the terminal: common options, configuration files, settings, progress, text.
namespace rayfield::cli {

/// What every command takes.
struct CommonOptions {
  bool json = false;
  ProgressStyle progress = ProgressStyle::automatic;
  int threads = 0;                                      ///< 0 = all processors
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< bound on resident memory
  bool dry_run = false;
  bool overwrite = false;
  int verbose = 0;
  bool quiet = false;
};

/// What a command has to say: `data` is the JSON document of --json, `text` what a person reads. Where its "exit_code"
/// is not 0 although the work was done, `failures` says why, a line each: with -q too, when `text` is not shown.
struct Outcome {
  nlohmann::ordered_json data;
  std::string text;
  std::vector<std::string> failures = {};
};

/// A command under way: its options, its progress.
struct Context {
  const CommonOptions& options;
  Progress& progress;
  std::string command_line;  ///< for the store's log
};

/// Declares a command: its own options are added by the caller to the returned app, `run` does the work.
class Commands {
 public:
  explicit Commands(CLI::App& app) : app_(app) {}
  CLI::App* add(const std::string& name, const std::string& description, const std::string& example,
                std::function<Result<Outcome>(Context&)> run);
  /// The same without the options that all others share: a command that only speaks of the program.
  CLI::App* add_plain(const std::string& name, const std::string& description, const std::string& example,
                      std::function<Result<Outcome>(Context&)> run);
  /// The program, with all that was declared.
  const CLI::App& app() const { return app_; }
  /// The parsed command's work; call after CLI::App::parse().
  Result<Outcome> run_parsed(const std::string& command_line);
  const CommonOptions& options() const { return options_; }

 private:
  struct Command {
    CLI::App* app;
    std::function<Result<Outcome>(Context&)> run;
  };
  void add_common_options(CLI::App& command);
  CLI::App& app_;
  CommonOptions options_;
  std::vector<Command> commands_;
};

/// `--date`, which picks some of several scans: given several times or as a list with commas.
void add_dates_option(CLI::App& command, std::vector<std::string>& dates, const std::string& meaning);

/// Accepts the number of a snapshot: whole, as `rayfield log` shows it.
const CLI::Validator& snapshot_number();

/// "4G", "512M", "1.5GiB", "1000000" → bytes (binary multiples). Errors: usage.
Result<std::uint64_t> parse_memory(const std::string& text);

}  // namespace rayfield::cli
