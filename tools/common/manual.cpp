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

/// Calls back with a command and the words that lead to it ("results list"; empty for the program itself),
/// each command before those below it.
using Visit = std::function<void(const std::string& words, const CLI::App& command)>;
void forEachCommand(const CLI::App& app, const Visit& visit, const std::string& words = {}) {
  visit(words, app);
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    forEachCommand(*command, visit, words.empty() ? command->get_name() : words + " " + command->get_name());
}

std::vector<const CLI::Option*> optionsOf(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
}

/// Text that troff takes as it is.
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
  // A line that begins with a point or an apostrophe would be a request.
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

/// The lines of a shell's `case` that follow the typed words down to the command.
std::string commandCases(const CLI::App& app) {
  std::string cases;
  forEachCommand(app, [&](const std::string& words, const CLI::App&) {
    if (!words.empty()) cases += fmt::format("      {}) command={} ;;\n", shellWord(words), shellWord(words));
  });
  return cases;
}

/// All flags of the options that take one of a few words, by the words.
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
      // Every command has its own --help; telling it once is enough.
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

void addDescriptionOptions(CLI::App& app, const std::string& version) {
  // CLI11 prints what is thrown so and ends well, as for --version.
  app.add_flag_callback(
      "--print-man", [&app, version] { throw CLI::CallForVersion(manualPage(app, version), 0); },
      "print this program's manual page");
  app.add_option_function<std::string>(
         "--print-completion",
         [&app](const std::string& shell) {
           throw CLI::CallForVersion(shell == "zsh" ? zshCompletion(app) : bashCompletion(app), 0);
         },
         "print a completion script")
      ->check(CLI::IsMember({"bash", "zsh"}));
}

}  // namespace lumivox::command
