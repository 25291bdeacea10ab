// A program's manual page and shell completions, generated from the options that it parses.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace lumivox::command {

/// A manual page (section 1, troff with the macros of man(7)) of all commands and options.
std::string manualPage(const CLI::App& app, const std::string& version);

/// A completion script for commands, options and the choices of an option; files everywhere else.
std::string bashCompletion(const CLI::App& app);
std::string zshCompletion(const CLI::App& app);
std::string fishCompletion(const CLI::App& app);

/// --print-man and --print-completion bash|zsh|fish. Call it after all commands were added.
void addDescriptionOptions(CLI::App& app, const std::string& version);

}  // namespace lumivox::command
