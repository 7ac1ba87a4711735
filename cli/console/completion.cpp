#include "cli/console/completion.h"

#include <fmt/format.h>

#include <string_view>
#include <vector>

namespace rayfield::cli {
namespace {

// In single quotes, for all three shells; fish alone wants a quote inside them written otherwise.
std::string quoted(std::string_view text, std::string_view quote_inside) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'')
      out += quote_inside;
    else
      out += c;
  }
  return out + "'";
}

std::string names_of(std::span<const CommandEntry> commands) {
  std::string names;
  for (const CommandEntry& command : commands) names += (names.empty() ? "" : " ") + command.name;
  return names;
}

// zsh's _arguments reads brackets and colons.
std::string zsh_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_values(const OptionEntry& option) {
  const std::string name = zsh_text(option.value);
  if (option.is_list && !option.choices.empty())
    return fmt::format(":{}:_values -s , {} {}", name, name, fmt::join(option.choices, " "));
  if (!option.choices.empty()) return fmt::format(":{}:({})", name, fmt::join(option.choices, " "));
  return fmt::format(":{}:{}", name, option.takes_path ? "_files" : "");
}

std::string zsh_option(const OptionEntry& option, const std::string& name) {
  const std::string value = option.value.empty() ? "" : zsh_values(option);
  return quoted(fmt::format("*{}[{}]{}", name, zsh_text(option.meaning), value), "'\\''");
}

// -s o -l output
std::string fish_names(const OptionEntry& option) {
  std::string names;
  for (const std::string& name : option.names)
    names += name.rfind("--", 0) == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1);
  return names;
}

constexpr std::string_view kBashHead = R"(# Completion of rayfield for bash, made by `rayfield completion bash`.
_rayfield() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} verb=${COMP_WORDS[1]}
  local options='' choices='' before='' list=0
  COMPREPLY=()
  # bash cuts --format=png into three words.
  if [[ $cur == = ]]; then
    cur=''
  elif [[ $prev == = ]]; then
    prev=${COMP_WORDS[COMP_CWORD-2]}
  fi
)";

constexpr std::string_view kBashTail = R"(  if [[ $cur == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$cur"))
    return
  fi
  if ((list)) && [[ $cur == *,* ]]; then
    before=${cur%,*},
    cur=${cur##*,}
  fi
  [[ -z $choices ]] || COMPREPLY=($(compgen -P "$before" -W "$choices" -- "$cur"))
}
complete -o default -F _rayfield rayfield
)";

// What follows an option: its choices, files (bash's own default), or nothing that is known.
std::string bash_values(const CommandEntry& command) {
  std::string text;
  for (const OptionEntry& option : command.options) {
    if (option.value.empty() || option.takes_path) continue;
    const std::string action =
        option.choices.empty()
            ? "compopt +o default 2>/dev/null; return"
            : fmt::format("choices='{}' list={}", fmt::join(option.choices, " "), option.is_list ? 1 : 0);
    text += fmt::format("        {}) {} ;;\n", fmt::join(option.names, "|"), action);
  }
  return text;
}

std::string bash_command(const CommandEntry& command) {
  std::vector<std::string> options;
  for (const OptionEntry& option : command.options)
    options.insert(options.end(), option.names.begin(), option.names.end());
  std::string text = fmt::format("    {})\n      options='{}'\n", command.name, fmt::join(options, " "));
  std::vector<std::string> words;
  for (const OptionEntry& argument : command.arguments)
    words.insert(words.end(), argument.choices.begin(), argument.choices.end());
  if (!words.empty()) text += fmt::format("      choices='{}'\n", fmt::join(words, " "));
  const std::string values = bash_values(command);
  if (!values.empty()) text += fmt::format("      case $prev in\n{}      esac\n", values);
  return text + "      ;;\n";
}

}  // namespace

std::string bash_completion(std::span<const CommandEntry> commands) {
  std::string text(kBashHead);
  text += fmt::format(
      "  if ((COMP_CWORD == 1)); then\n"
      "    COMPREPLY=($(compgen -W '{} --help --version' -- \"$cur\"))\n"
      "    return\n"
      "  fi\n"
      "  case $verb in\n",
      names_of(commands));
  for (const CommandEntry& command : commands) text += bash_command(command);
  return text + "  esac\n" + std::string(kBashTail);
}

std::string zsh_completion(std::span<const CommandEntry> commands) {
  std::string text =
      "#compdef rayfield\n"
      "# Completion of rayfield for zsh, made by `rayfield completion zsh`.\n"
      "_rayfield() {\n"
      "  local -a verbs=(\n";
  for (const CommandEntry& command : commands)
    text += fmt::format("    {}\n", quoted(command.name + ":" + zsh_text(command.meaning), "'\\''"));
  text +=
      "  )\n"
      "  if (( CURRENT == 2 )); then\n"
      "    _describe -t commands command verbs\n"
      "    [[ $PREFIX == -* ]] && compadd -- --help --version\n"
      "    return\n"
      "  fi\n"
      "  shift words\n"
      "  (( CURRENT-- ))\n"
      "  case $words[1] in\n";
  for (const CommandEntry& command : commands) {
    text += fmt::format("    {})\n      _arguments", command.name);
    for (const OptionEntry& option : command.options)
      for (const std::string& name : option.names) text += " \\\n        " + zsh_option(option, name);
    std::size_t place = 0;
    for (const OptionEntry& argument : command.arguments)
      text += fmt::format(" \\\n        {}", quoted(fmt::format("{}{}", ++place, zsh_values(argument)), "'\\''"));
    text += " \\\n        '*:file:_files'\n      ;;\n";
  }
  return text + "  esac\n}\n_rayfield \"$@\"\n";
}

std::string fish_completion(std::span<const CommandEntry> commands) {
  std::string text = "# Completion of rayfield for fish, made by `rayfield completion fish`.\n";
  const auto meaning = [](const std::string& words) { return quoted(words, "\\'"); };
  text += "complete -c rayfield -n __fish_use_subcommand -s V -l version -d 'Show the version'\n";
  for (const CommandEntry& command : commands) {
    text += fmt::format("complete -c rayfield -n __fish_use_subcommand -f -a {} -d {}\n", command.name,
                        meaning(command.meaning));
    const std::string where = fmt::format("complete -c rayfield -n '__fish_seen_subcommand_from {}'", command.name);
    for (const OptionEntry& option : command.options) {
      const std::string takes = option.value.empty() ? "" : option.takes_path ? " -r" : " -x";
      const std::string choices = option.choices.empty() ? "" : fmt::format(" -a '{}'", fmt::join(option.choices, " "));
      text += fmt::format("{}{}{}{} -d {}\n", where, fish_names(option), takes, choices, meaning(option.meaning));
    }
    for (const OptionEntry& argument : command.arguments)
      if (!argument.choices.empty()) text += fmt::format("{} -f -a '{}'\n", where, fmt::join(argument.choices, " "));
  }
  return text;
}

}  // namespace rayfield::cli
