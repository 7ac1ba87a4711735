#include "cli/console/man_page.h"

#include <fmt/format.h>

#include <cstdint>
#include <string_view>
#include <vector>

namespace rayfield::cli {
namespace {

// A character outside of ASCII as \[uXXXX]; returns how many bytes it took. `text`: valid UTF-8, as our own texts are.
std::size_t put_character(std::string_view text, std::string& out) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  const std::size_t length = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  std::uint32_t code = byte(0) & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length && i < text.size(); ++i) code = code << 6U | (byte(i) & 0x3FU);
  out += fmt::format("\\[u{:04X}]", code);
  return length;
}

// Text for a line of its own: nothing in it is taken for a request or an escape, and - stays what is typed.
std::string roff(std::string_view text) {
  std::string out;
  if (!text.empty() && (text[0] == '.' || text[0] == '\'')) out += "\\&";
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (static_cast<unsigned char>(c) >= 0x80) {
      i += put_character(text.substr(i), out);
      continue;
    }
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\n')
      out += "\n.br\n";
    else
      out += c;
    ++i;
  }
  return out;
}

std::string head(const std::string& title, const std::string& version, const std::string& date) {
  std::string upper = title;
  for (char& c : upper)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return fmt::format(".TH {} 1 {} \"rayfield {}\" \"User Commands\"\n", roff(upper), date, version);
}

std::string paragraph_of(const OptionEntry& option) {
  std::string text = ".TP\n";
  for (std::size_t i = 0; i < option.names.size(); ++i)
    text += fmt::format("{}\\fB{}\\fR", i == 0 ? "" : ", ", roff(option.names[i]));
  const bool is_argument = option.names.front().front() != '-';
  if (!option.value.empty() && !is_argument) text += fmt::format(" \\fI{}\\fR", roff(option.value));
  text += "\n" + roff(option.meaning);
  if (!option.choices.empty())
    text += fmt::format("\n.br\nOne of: {}", roff(fmt::format("{}", fmt::join(option.choices, ", "))));
  return text + (option.is_required && !is_argument ? "\n.br\nRequired.\n" : "\n");
}

std::string section(const std::string& title, const std::vector<const OptionEntry*>& options) {
  if (options.empty()) return {};
  std::string text = ".SH " + title + "\n";
  for (const OptionEntry* option : options) text += paragraph_of(*option);
  return text;
}

constexpr std::string_view kExitStatus = R"(.SH EXIT STATUS
.TP
.B 0
Done, and durable.
.TP
.B 1
Internal error.
.TP
.B 2
Wrong usage or configuration.
.TP
.B 3
Bad or unreadable input.
.TP
.B 4
The store is damaged.
.TP
.B 5
Out of disk, memory or permission.
.TP
.B 6
Another writer holds the store.
.TP
.B 130
Interrupted; the same command goes on.
)";

}  // namespace

std::string program_page(std::span<const CommandEntry> commands, const std::string& version, const std::string& date) {
  std::string text = head("rayfield", version, date);
  text +=
      ".SH NAME\n"
      "rayfield \\- lidar drives through vineyards and orchards to canopy density maps\n"
      ".SH SYNOPSIS\n.B rayfield\n.I COMMAND\n.RI [ ARGUMENT ...]\n"
      ".SH DESCRIPTION\n"
      "Registers logs of a spinning lidar on a farm vehicle, keeps their rays in a store with all dates of a block, "
      "and\n"
      "maps one\\-sided leaf area per cubic metre, panel, half metre of row and as a plan raster.\n"
      ".SH COMMANDS\n";
  for (const CommandEntry& command : commands)
    text += fmt::format(".TP\n.BR rayfield\\-{} (1)\n{}\n", roff(command.name), roff(command.meaning));
  text +=
      ".SH OPTIONS\n.TP\n.BR \\-h \", \" \\-\\-help\nShow all commands; behind a command what it takes.\n"
      ".TP\n.BR \\-V \", \" \\-\\-version\nShow the version.\n";
  text += kExitStatus;
  return text + ".SH EXAMPLE\n.nf\nrayfield demo out/demo\n.fi\n";
}

std::string command_page(const CommandEntry& command, const std::string& version, const std::string& date) {
  std::vector<const OptionEntry*> arguments, own, common;
  std::string synopsis = fmt::format(".B rayfield {}\n", roff(command.name));
  for (const OptionEntry& argument : command.arguments) {
    arguments.push_back(&argument);
    synopsis += argument.is_required ? fmt::format(".I {}\n", roff(argument.value))
                                     : fmt::format(".RI [ {} ]\n", roff(argument.value));
  }
  for (const OptionEntry& option : command.options) {
    (option.is_common ? common : own).push_back(&option);
    if (option.is_required) synopsis += fmt::format(".BI {} \" {}\"\n", roff(option.names.back()), roff(option.value));
  }
  return fmt::format("{}.SH NAME\nrayfield\\-{} \\- {}\n.SH SYNOPSIS\n{}.RI [ OPTION ...]\n.SH DESCRIPTION\n{}.\n",
                     head("rayfield-" + command.name, version, date), roff(command.name), roff(command.meaning),
                     synopsis, roff(command.meaning)) +
         section("ARGUMENTS", arguments) + section("OPTIONS", own) + section("\"COMMON OPTIONS\"", common) +
         fmt::format(".SH EXAMPLE\n.nf\n{}\n.fi\n.SH SEE ALSO\n.BR rayfield (1)\n", roff(command.example));
}

}  // namespace rayfield::cli
