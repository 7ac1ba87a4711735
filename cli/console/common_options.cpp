#include "cli/console/common_options.h"

#include <fmt/core.h>

#include <cmath>
#include <map>

#include "rayfield/core/parallel.h"

namespace rayfield::cli {

Result<std::uint64_t> parse_memory(const std::string& text) {
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  const std::string unit = text.substr(used);
  double factor = 0;
  if (unit.empty() || unit == "B") factor = 1;
  for (const auto& [letter, power] : {std::pair{'K', 10}, {'M', 20}, {'G', 30}, {'T', 40}}) {
    const std::string l(1, letter), lower(1, static_cast<char>(letter - 'A' + 'a'));
    if (unit == l || unit == lower || unit == l + "B" || unit == l + "iB") factor = std::ldexp(1.0, power);
  }
  const double bytes = value * factor;
  if (used == 0 || factor == 0 || !std::isfinite(bytes) || bytes < 0 || bytes > 9e18)
    return fail(ErrorCode::usage, "bad --memory", text, "not an amount of memory", "give e.g. 4G or 512M");
  if (bytes < 256.0 * 1024 * 1024)
    return fail(ErrorCode::usage, "bad --memory", text, "rayfield needs at least 256M", "give e.g. 1G");
  return static_cast<std::uint64_t>(bytes);
}

void add_dates_option(CLI::App& command, std::vector<std::string>& dates, const std::string& meaning) {
  command.add_option("--date", dates, meaning)
      ->type_name("DATE[,DATE...]")
      ->delimiter(',')
      ->allow_extra_args(false);  // what follows is not a date but, say, the store
}

const CLI::Validator& snapshot_number() {
  static const CLI::Validator kNumber(
      [](std::string& text) {
        const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
        return digits && text.size() < 20 ? std::string()
                                          : text + " is no snapshot's number, which are 1, 2, … (`rayfield log`)";
      },
      "");
  return kNumber;
}

CLI::App* Commands::add_plain(const std::string& name, const std::string& description, const std::string& example,
                              std::function<Result<Outcome>(Context&)> run) {
  CLI::App* command = app_.add_subcommand(name, description);
  command->footer("Example:\n  " + example);
  commands_.push_back({command, std::move(run)});
  return command;
}

CLI::App* Commands::add(const std::string& name, const std::string& description, const std::string& example,
                        std::function<Result<Outcome>(Context&)> run) {
  CLI::App* command = add_plain(name, description, example, std::move(run));
  add_common_options(*command);
  return command;
}

// Options that all commands have, declared once, so that help, manual and completion agree.
void Commands::add_common_options(CLI::App& command) {
  command.add_flag("--json", options_.json, "Print exactly one JSON document on stdout")->group("Common");
  static const std::map<std::string, ProgressStyle> kStyles{{"bar", ProgressStyle::bar},
                                                            {"plain", ProgressStyle::plain},
                                                            {"json", ProgressStyle::json},
                                                            {"none", ProgressStyle::none}};
  command
      .add_option_function<std::string>(
          "--progress", [this](const std::string& style) { options_.progress = kStyles.at(style); },
          "How to show progress on stderr: bar, plain, json or none (default: bar on a terminal, else plain)")
      ->transform(CLI::IsMember(&kStyles, CLI::ignore_case).description(""))
      ->type_name("bar|plain|json|none")
      ->group("Common");
  command.add_option("--threads", options_.threads, "Worker threads (default: all processors)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N")
      ->group("Common");
  command
      .add_option_function<std::string>(
          "--memory",
          [this](const std::string& text) {
            const Result<std::uint64_t> bytes = parse_memory(text);
            if (!bytes) throw CLI::ValidationError(bytes.error().line());
            options_.memory_bytes = *bytes;
          },
          "Bound on resident memory, e.g. 1G (default 4G)")
      ->type_name("SIZE")
      ->group("Common");
  command.add_flag("--dry-run", options_.dry_run, "Say what would be done and what it needs; change nothing")
      ->group("Common");
  command.add_flag("--overwrite", options_.overwrite, "Replace what is there already")->group("Common");
  command.add_flag("-v,--verbose", options_.verbose, "Say more")->group("Common");
  command.add_flag("-q,--quiet", options_.quiet, "No progress and no summary, only errors")->group("Common");
  command.add_option("--config", "TOML file with values for options of this command (unknown keys are refused)")
      ->type_name("FILE.toml")
      ->group("Common");
}

namespace {

// What is named by its place or by -o is a file, a folder or a name of something: never nothing.
Result<void> check_named(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional() && !option->check_sname("o")) continue;
    for (const std::string& text : option->results())
      if (text.empty())
        return fail(ErrorCode::usage, "cannot run rayfield " + command.get_name(), option->get_name(), "it is empty",
                    "give a path");
  }
  return {};
}

}  // namespace

Result<Outcome> Commands::run_parsed(const std::string& command_line) {
  for (const Command& command : commands_) {
    if (!command.app->parsed()) continue;
    RAYFIELD_CHECK(check_named(*command.app));
    ProgressReporter progress(options_.progress, options_.quiet);
    options_.threads = thread_count(options_.threads);
    Context context{options_, progress, command_line};
    Result<Outcome> outcome = command.run(context);
    progress.finish();
    return outcome;
  }
  return fail(ErrorCode::usage, "no command", "", "", "see `rayfield --help`");
}

}  // namespace rayfield::cli
