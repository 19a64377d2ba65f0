#include <fmt/format.h>

#include "manual/manual.hpp"

namespace rfmvo::manual {
namespace {

// Text that roff takes literally.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\n')
      out += ' ';
    else
      out += c;
  }
  // A line that begins like this would be a request.
  if (!out.empty() && (out.front() == '.' || out.front() == '\'')) out.insert(0, "\\&");
  return out;
}

std::string value_of(const CLI::Option& option) {
  if (option.get_expected_max() == 0) return "";
  std::string type = option.get_type_name();
  return type.empty() ? "" : " \\fI" + roff(type.substr(0, type.find(':'))) + "\\fR";
}

// "--rotate, --keep"; of a positional its name.
std::string names_of(const CLI::Option& option) {
  if (option.nonpositional()) return option.get_name(false, true);
  return option.get_name(true);
}

std::string option_entry(const CLI::Option& option) {
  std::string text =
      fmt::format(".TP\n\\fB{}\\fR{}\n{}", roff(names_of(option)), value_of(option), roff(option.get_description()));
  const std::string type = option.get_type_name();
  if (const auto open = type.find('{'); open != std::string::npos) {
    text += ": ";
    // A space, so that long lists can be broken.
    for (const char c : type.substr(open)) text += c == ',' ? ", " : roff(std::string(1, c));
  }
  if (!option.get_default_str().empty()) text += roff(" (default: " + option.get_default_str() + ")");
  return text + "\n";
}

std::string synopsis(const std::string& name, const CLI::App& command) {
  std::string text = "\\fBrfmvo " + roff(name) + "\\fR";
  for (const CLI::Option* option : command.get_options()) {
    if (option->nonpositional()) continue;
    const std::string value = "\\fI" + roff(option->get_name(true)) + "\\fR";
    text += option->get_required() ? " " + value : " [" + value + "]";
  }
  return text + " [\\fIoptions\\fR]";
}

}  // namespace

std::vector<std::pair<std::string, const CLI::App*>> commands_of(const CLI::App& app) {
  std::vector<std::pair<std::string, const CLI::App*>> all;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    const auto inner = commands_of(*command);
    if (inner.empty()) all.emplace_back(command->get_name(), command);
    for (const auto& [name, sub] : inner) all.emplace_back(command->get_name() + " " + name, sub);
  }
  return all;
}

std::string man_page(const CLI::App& app, const std::string& version) {
  std::string text =
      fmt::format(".TH RFMVO 1 \"\" \"rfmvo {}\" \"User Commands\"\n.ad l\n.nh\n.SH NAME\nrfmvo \\- {}\n",
                  roff(version), roff(app.get_description()));
  text += ".SH SYNOPSIS\n";
  const auto commands = commands_of(app);
  for (const auto& [name, command] : commands) text += synopsis(name, *command) + "\n.br\n";
  text += ".SH COMMANDS\n";
  for (const auto& [name, command] : commands) {
    text += fmt::format(".SS {}\n{}\n", roff(name), roff(command->get_description()));
    for (const CLI::Option* option : command->get_options()) text += option_entry(*option);
  }
  text += ".SH EXIT STATUS\n" + roff(kExitCodes) + "\n";
  return text +
         ".SH ENVIRONMENT\n.TP\n\\fBNO_COLOR\\fR\nNo colours on a terminal. Where the output is no terminal, there are "
         "none.\n.SH SEE ALSO\nlcm\\-spy(1), lcm\\-logplayer(1)\n";
}

}  // namespace rfmvo::manual
