// A program's description of itself as a manual page and as completions for shells: written from the same
// options that it reads.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace lumivox::command {

/// A manual page (section 1, troff with the macros of man(7)) of all commands and options.
std::string manualPage(const CLI::App& app, const std::string& version);

/// A completion script: commands, options, and the words that an option may take; files elsewhere.
std::string bashCompletion(const CLI::App& app);
std::string zshCompletion(const CLI::App& app);
std::string fishCompletion(const CLI::App& app);

/// --print-man and --print-completion bash|zsh|fish. Call it when all commands are there.
void addDescriptionOptions(CLI::App& app, const std::string& version);

}  // namespace lumivox::command
