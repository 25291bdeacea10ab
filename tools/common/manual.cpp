#include "common/manual.h"

#include <fmt/format.h>

#include <functional>
#include <vector>

namespace lumivox::command {
namespace {

/// "--device TEXT:{auto,software}" without the words after the colon.
std::string valueName(const CLI::Option& option) {
  const std::string type = option.get_type_size() == 0 ? "" : option.get_type_name();
  return type.substr(0, type.find(':'));
}

/// The words that the option may take, from the description of its check: "{auto,spirv,glsl}".
std::vector<std::string> choicesOf(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.find('}', open);
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

/// "-o" and "--out" for `-o,--out`; nothing for a positional.
std::vector<std::string> flagsOf(const CLI::Option& option) {
  std::vector<std::string> flags;
  for (const std::string& name : option.get_snames()) flags.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) flags.push_back("--" + name);
  return flags;
}

/// Receives each command with its words ("results list"; empty for the program itself), before its
/// subcommands.
using Visit = std::function<void(const std::string& words, const CLI::App& command)>;
void forEachCommand(const CLI::App& app, const Visit& visit, const std::string& words = {}) {
  visit(words, app);
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    forEachCommand(*command, visit, words.empty() ? command->get_name() : words + " " + command->get_name());
}

std::vector<const CLI::Option*> optionsOf(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
}

/// Text escaped for troff.
std::string troff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\')
      escaped += "\\e";
    else if (c == '-')
      escaped += "\\-";
    else
      escaped += c;
  }
  // troff would take a line that begins with a point or an apostrophe for a request.
  return !escaped.empty() && (escaped[0] == '.' || escaped[0] == '\'') ? "\\&" + escaped : escaped;
}

std::string optionEntry(const CLI::Option& option) {
  std::string head;
  for (const std::string& flag : flagsOf(option))
    head += (head.empty() ? "" : ", ") + fmt::format("\\fB{}\\fR", troff(flag));
  const std::vector<std::string> choices = choicesOf(option);
  if (head.empty())
    head = fmt::format("\\fI{}\\fR", troff(option.get_name()));
  else if (option.get_type_size() != 0)
    head += choices.empty() ? fmt::format(" \\fI{}\\fR", troff(valueName(option)))
                            : " " + troff(fmt::format("{}", fmt::join(choices, "|")));
  return ".TP\n" + head + "\n" + troff(option.get_description()) + "\n";
}

/// A word in single quotes, as both shells read it.
std::string shellWord(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string functionName(const CLI::App& app) {
  return "_" + app.get_name();
}

/// The branches of a shell's `case` that find the command from the typed words.
std::string commandCases(const CLI::App& app) {
  std::string cases;
  forEachCommand(app, [&](const std::string& words, const CLI::App&) {
    if (!words.empty()) cases += fmt::format("      {}) command={} ;;\n", shellWord(words), shellWord(words));
  });
  return cases;
}

/// A branch of a shell's `case` for each flag of an option with fixed choices: `action` with the choices.
std::string choiceCases(const CLI::App& app, const std::string& action) {
  std::string cases;
  forEachCommand(app, [&](const std::string& words, const CLI::App& command) {
    for (const CLI::Option* option : optionsOf(command)) {
      const std::vector<std::string> choices = choicesOf(*option), flags = flagsOf(*option);
      if (choices.empty() || flags.empty()) continue;
      // Options of the program itself stand behind every command, too.
      for (const std::string& flag : flags)
        cases += fmt::format("    {}) {} ;;\n",
                             words.empty() ? "*" + shellWord(" " + flag) : shellWord(words + " " + flag),
                             fmt::format(fmt::runtime(action), fmt::join(choices, " ")));
    }
  });
  return cases;
}

}  // namespace

std::string manualPage(const CLI::App& app, const std::string& version) {
  const std::string name = app.get_name();
  std::string upper = name;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string summary = app.get_description();
  summary = summary.substr(0, summary.find_first_of(":;"));
  std::string text = fmt::format(".TH {} 1 \"\" \"{} {}\" \"User Commands\"\n", upper, name, version);
  text += fmt::format(".SH NAME\n{} \\- {}\n.SH SYNOPSIS\n", name, troff(summary));
  const bool hasCommands = !app.get_subcommands([](const CLI::App*) { return true; }).empty();
  text += fmt::format(".B {}\n{}\n.SH DESCRIPTION\n{}\n", name,
                      hasCommands ? "[\\fIOPTIONS\\fR] \\fICOMMAND\\fR ..." : "[\\fIOPTIONS\\fR] ...",
                      troff(app.get_description()));
  forEachCommand(app, [&](const std::string& words, const CLI::App& command) {
    if (words.empty()) {
      text += hasCommands ? ".SH OPTIONS OF EVERY COMMAND\n" : ".SH OPTIONS\n";
    } else {
      if (words == app.get_subcommands([](const CLI::App*) { return true; }).front()->get_name())
        text += ".SH COMMANDS\n";
      text += fmt::format(".SS {}\n{}\n", troff(name + " " + words), troff(command.get_description()));
    }
    for (const CLI::Option* option : optionsOf(command))
      // Every command has a --help of its own; it is described once.
      if (words.empty() || option->get_name() != "--help") text += optionEntry(*option);
  });
  text +=
      ".SH EXIT STATUS\n.TP\n.B 0\nsuccess\n.TP\n.B 1\ndone, but a check failed\n"
      ".TP\n.B 2\nbad input, or something is missing; nothing was written\n";
  return text;
}

std::string bashCompletion(const CLI::App& app) {
  std::string text = fmt::format(
      "# bash completion of {0}, written by `{0} --print-completion bash`\n"
      "{1}() {{\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}} command= flags= commands= word\n"
      "  COMPREPLY=()\n"
      "  for word in \"${{COMP_WORDS[@]:1:COMP_CWORD-1}}\"; do\n"
      "    word=${{command:+$command }}$word\n"
      "    case $word in\n{2}    esac\n  done\n"
      "  case \"$command ${{COMP_WORDS[COMP_CWORD-1]}}\" in\n{3}  esac\n",
      app.get_name(), functionName(app), commandCases(app),
      choiceCases(app, "COMPREPLY=($(compgen -W '{}' -- \"$current\")); return"));
  std::string global;
  text += "  case $command in\n";
  forEachCommand(app, [&](const std::string& words, const CLI::App& command) {
    std::string flags, commands;
    for (const CLI::Option* option : optionsOf(command))
      for (const std::string& flag : flagsOf(*option)) flags += (flags.empty() ? "" : " ") + flag;
    for (const CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; }))
      commands += (commands.empty() ? "" : " ") + below->get_name();
    if (words.empty()) global = flags;
    text += fmt::format("    {}) flags={} commands={} ;;\n", shellWord(words), shellWord(flags),
                        shellWord(commands));
  });
  text += fmt::format(
      "  esac\n"
      "  if [[ $current == -* ]]; then\n"
      "    COMPREPLY=($(compgen -W \"$flags \"{} -- \"$current\"))\n"
      "  elif [[ -n $commands ]]; then\n"
      "    COMPREPLY=($(compgen -W \"$commands\" -- \"$current\"))\n"
      "  fi\n"
      "}}\n"
      "complete -o default -F {} {}\n",
      shellWord(global), functionName(app), app.get_name());
  return text;
}

std::string zshCompletion(const CLI::App& app) {
  // _describe takes "word:meaning"; a colon in the word would end it.
  const auto entry = [](const std::string& word, const std::string& meaning) {
    return " " + shellWord(word + ":" + meaning);
  };
  std::string text = fmt::format(
      "#compdef {0}\n"
      "# zsh completion of {0}, written by `{0} --print-completion zsh`\n"
      "{1}() {{\n"
      "  local command= word\n"
      "  local -a flags commands\n"
      "  for word in \"${{(@)words[2,CURRENT-1]}}\"; do\n"
      "    word=${{command:+$command }}$word\n"
      "    case $word in\n{2}    esac\n  done\n"
      "  case \"$command ${{words[CURRENT-1]}}\" in\n{3}  esac\n",
      app.get_name(), functionName(app), commandCases(app), choiceCases(app, "compadd {}; return"));
  text += "  case $command in\n";
  std::string global;
  forEachCommand(app, [&](const std::string& words, const CLI::App& command) {
    std::string flags, commands;
    for (const CLI::Option* option : optionsOf(command))
      for (const std::string& flag : flagsOf(*option)) flags += entry(flag, option->get_description());
    for (const CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; }))
      commands += entry(below->get_name(), below->get_description());
    if (words.empty()) global = flags;
    text += fmt::format("    {}) flags=({} ) commands=({} ) ;;\n", shellWord(words), flags, commands);
  });
  text += fmt::format(
      "  esac\n"
      "  [[ -n $command ]] && flags+=({} )\n"
      "  if [[ $PREFIX == -* ]]; then\n"
      "    _describe -o option flags\n"
      "  elif (( $#commands )); then\n"
      "    _describe command commands\n"
      "  else\n"
      "    _files\n"
      "  fi\n"
      "}}\n"
      "{} \"$@\"\n",
      global, functionName(app));
  return text;
}

std::string fishCompletion(const CLI::App& app) {
  const std::string name = app.get_name(), condition = fmt::format("__{}_at", name);
  // fish knows no escape but \\ and \' in single quotes.
  const auto quoted = [](const std::string& text) {
    std::string result = "'";
    for (const char c : text) result += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return result + "'";
  };
  std::string text = fmt::format(
      "# fish completion of {0}, written by `{0} --print-completion fish`\n"
      "# Whether the words so far lead down to the command.\n"
      "function {1}\n"
      "  set -l command\n"
      "  for word in (commandline -opc)[2..-1]\n"
      "    switch \"$command $word\"\n",
      name, condition);
  forEachCommand(app, [&](const std::string& words, const CLI::App&) {
    if (words.empty()) return;
    const std::size_t space = words.rfind(' ');
    const std::string before = space == std::string::npos ? "" : words.substr(0, space);
    text += fmt::format("      case {}; set command {}\n",
                        quoted(before + " " + words.substr(space == std::string::npos ? 0 : space + 1)),
                        quoted(words));
  });
  text += "    end\n  end\n  test \"$command\" = \"$argv\"\nend\n";
  forEachCommand(app, [&](const std::string& words, const CLI::App& command) {
    const std::string here = fmt::format("complete -c {} -n {}", name, quoted(condition + " " + words));
    for (const CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; }))
      text += fmt::format("{} -f -a {} -d {}\n", here, below->get_name(), quoted(below->get_description()));
    for (const CLI::Option* option : optionsOf(command)) {
      if (flagsOf(*option).empty()) continue;
      // Options of the program itself stand behind every command, too.
      std::string line = words.empty() ? "complete -c " + name : here;
      if (!words.empty() && option->get_name() == "--help") continue;
      for (const std::string& flag : option->get_snames()) line += " -s " + flag;
      for (const std::string& flag : option->get_lnames()) line += " -l " + flag;
      const std::vector<std::string> choices = choicesOf(*option);
      if (!choices.empty())
        line += " -x -a " + quoted(fmt::format("{}", fmt::join(choices, " ")));
      else if (option->get_type_size() != 0)
        line += " -r";
      text += line + " -d " + quoted(option->get_description()) + "\n";
    }
  });
  return text;
}

void addDescriptionOptions(CLI::App& app, const std::string& version) {
  // CLI11 prints the text of this exception and exits with 0, as for --version.
  app.add_flag_callback(
      "--print-man", [&app, version] { throw CLI::CallForVersion(manualPage(app, version), 0); },
      "print this program's manual page");
  app.add_option_function<std::string>(
         "--print-completion",
         [&app](const std::string& shell) {
           throw CLI::CallForVersion(shell == "zsh"    ? zshCompletion(app)
                                     : shell == "fish" ? fishCompletion(app)
                                                       : bashCompletion(app),
                                     0);
         },
         "print a completion script")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
}

}  // namespace lumivox::command
