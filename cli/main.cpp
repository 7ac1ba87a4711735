#include <fmt/core.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "cli/commands/commands.h"
#include "cli/console/common_options.h"
#include "cli/console/config_file.h"
#include "cli/console/text.h"
#include "cli/console/usage_error.h"
#include "version.h"

namespace {

using rayfield::Error;
using rayfield::ErrorCode;
using rayfield::cli::with_config_place;

int report(const Error& error, bool json) {
  fmt::print(stderr, "rayfield: {}\n", error.line());
  if (json) {
    const nlohmann::ordered_json document = {{"error",
                                              {{"code", static_cast<int>(error.code)},
                                               {"what", error.what},
                                               {"where", error.where},
                                               {"why", error.why},
                                               {"next", error.next}}}};
    fmt::print("{}\n", document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  }
  return static_cast<int>(error.code);
}

// Prints what a command says. A full disk behind stdout must not look like success: 0, or the error's exit code.
int print(const std::string& text) {
  const bool taken = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (std::fflush(stdout) == 0 && taken) return 0;
  return report(rayfield::fail_output(errno, "cannot write the result", "stdout").value(), false);
}

// Declares the commands, puts a configuration file's options into the arguments, runs the one that was asked for, and
// prints what it says: an error as one line, with --json as one document too.
int run(int argc, char** argv) {
  CLI::App app{"rayfield: lidar drives through vineyards and orchards to canopy density maps", "rayfield"};
  app.set_version_flag("-V,--version", std::string("rayfield ") + rayfield::cli::kVersion);
  app.require_subcommand(1);
  rayfield::cli::Commands commands(app);
  rayfield::cli::add_all_commands(commands);

  std::vector<std::string> arguments(argv + 1, argv + argc);
  // Before the options are known to be right, the word itself must do.
  const bool json = std::find(arguments.begin(), arguments.end(), "--json") != arguments.end();
  std::string command_line = "rayfield";
  for (const std::string& argument : arguments) command_line += " " + argument;
  auto expanded = rayfield::cli::expand_config(app, arguments);
  if (!expanded) return report(expanded.error(), json);

  try {
    std::vector<std::string> reversed(expanded->arguments.rbegin(), expanded->arguments.rend());
    app.parse(reversed);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {  // --help, --version
      std::ostringstream text;
      app.exit(e, text, text);
      return print(text.str());
    }
    return report(with_config_place(rayfield::cli::usage_error(app, arguments, e), expanded->places), json);
  }

  const auto outcome = commands.run_parsed(command_line);
  if (!outcome) return report(with_config_place(outcome.error(), expanded->places), commands.options().json);
  int not_printed = 0;
  if (commands.options().json) {
    not_printed = print(outcome->data.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  } else if (!commands.options().quiet) {
    not_printed = print(rayfield::cli::printable(outcome->text));
  }
  if (commands.options().quiet)
    for (const std::string& failure : outcome->failures)
      fmt::print(stderr, "rayfield: {}\n", rayfield::cli::printable(failure));
  if (not_printed != 0) return not_printed;
  // `verify` ends with 4 when it found damage although it did its work.
  return outcome->data.is_object() ? outcome->data.value("exit_code", 0) : 0;
}

// Large arrays come and go, and the C library gives each back to the system and asks for it again, page by page: a
// seventh of the time of `process`. So blocks up to its limit for that, and this much at the end of the heap, are kept.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kMostKeptBlock = 32 << 20, kMostKept = 128 << 20;  // bytes
  mallopt(M_MMAP_THRESHOLD, kMostKeptBlock);
  mallopt(M_TRIM_THRESHOLD, kMostKept);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();
  rayfield::cli::install_interrupt_handlers();
  // A file that outgrows its limit is then an error of write() like a full disk, and not the end of the program.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    return report({ErrorCode::resources, "out of memory", "", "an allocation failed",
                   "give a smaller --memory or fewer --threads"},
                  false);
  } catch (const std::system_error& e) {  // of a library, or of a call that was not expected to fail
    const rayfield::Error error = rayfield::fail_errno(e.code().value(), "a system call failed", "").value();
    if (error.code == ErrorCode::resources) return report(error, false);
    return report({ErrorCode::internal, "internal error", "", e.what(), "please report this with the command line"},
                  false);
  } catch (const std::exception& e) {
    return report({ErrorCode::internal, "internal error", "", e.what(), "please report this with the command line"},
                  false);
  }
}
