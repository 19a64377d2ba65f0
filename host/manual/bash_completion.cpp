#include <fmt/format.h>

#include <algorithm>

#include "manual/manual.hpp"

namespace rfmvo::manual {
namespace {

// "TEXT:{joint,paper}": "joint paper"; empty: any text.
std::string choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.find('}', open);
  if (open == std::string::npos || close == std::string::npos) return "";
  std::string choices = type.substr(open + 1, close - open - 1);
  std::replace(choices.begin(), choices.end(), ',', ' ');
  return choices;
}

std::string names_of(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option.get_lnames()) names += (names.empty() ? "--" : " --") + name;
  return names;
}

std::string options_of(const CLI::App& command) {
  std::string all;
  for (const CLI::Option* option : command.get_options())
    if (option->nonpositional()) all += (all.empty() ? "" : " ") + names_of(*option);
  return all;
}

}  // namespace

std::string bash_completion(const CLI::App& app) {
  std::string names, groups, options, choices;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names += (names.empty() ? "" : " ") + command->get_name();
    std::string inner;
    for (const auto& [name, sub] : commands_of(*command)) inner += (inner.empty() ? "" : " ") + name;
    if (!inner.empty()) groups += fmt::format("    {}) words='{}' ;;\n", command->get_name(), inner);
  }
  for (const auto& [name, command] : commands_of(app)) {
    options += fmt::format("    '{}') options='{}' ;;\n", name, options_of(*command));
    for (const CLI::Option* option : command->get_options())
      if (const std::string words = choices_of(*option); !words.empty() && option->nonpositional())
        choices += fmt::format("    '{}:{}') words='{}' ;;\n", name, option->get_name(false, false), words);
  }
  return fmt::format(R"(# bash completion of rfmvo; made by `rfmvo completion`
_rfmvo() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} command=${{COMP_WORDS[1]}}
  local words= options=
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W '{} --help --version' -- "$current"))
    return
  fi
  case $command in
{}  esac
  if [ -n "$words" ]; then
    if [ "$COMP_CWORD" -eq 2 ]; then
      COMPREPLY=($(compgen -W "$words" -- "$current"))
      return
    fi
    command="$command ${{COMP_WORDS[2]}}"
    words=
  fi
  case $command:$previous in
{}  esac
  if [ -n "$words" ]; then
    COMPREPLY=($(compgen -W "$words" -- "$current"))
    return
  fi
  case $command in
{}  esac
  case $current in
    -*) COMPREPLY=($(compgen -W "$options" -- "$current")) ;;
    *) COMPREPLY=($(compgen -f -- "$current")) ;;
  esac
}}
complete -o filenames -F _rfmvo rfmvo
)",
                     names, groups, choices, options);
}

}  // namespace rfmvo::manual
