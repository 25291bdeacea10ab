// shaderpack: compiles a technique's shaders offline into one pack and one C++ header. See docs/shaders.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "build.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace {

namespace fs = std::filesystem;

/// Writes only a file that changes, so that the build does not repeat the targets that depend on it.
void writeIfChanged(const fs::path& path, const std::string& text) {
  if (fs::is_regular_file(path) && lumivox::readFile(path) == text) return;
  lumivox::createParentDirectories(path);
  lumivox::writeFileAtomically(path, text);
}

/// A Makefile rule, as ninja reads it.
std::string dependencyRule(const std::vector<fs::path>& outputs, const std::set<fs::path>& inputs) {
  const auto escaped = [](const fs::path& path) {
    std::string text;
    for (const char c : path.string()) {
      if (c == ' ' || c == '#') text += '\\';
      if (c == '$') text += '$';
      text += c;
    }
    return text;
  };
  std::string rule;
  for (const fs::path& output : outputs) rule += (rule.empty() ? "" : " ") + escaped(output);
  rule += ":";
  for (const fs::path& input : inputs) rule += " \\\n  " + escaped(input);
  return rule + "\n";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Compiles a technique's shaders into one pack (SPIR-V and GLSL of all reachable variants) and one C++ "
      "header."};
  lumivox::shaderpack::BuildOptions options;
  fs::path pack, header, depfile;
  app.add_option("--technique", options.technique, "Name of the technique")->required();
  app.add_option("--source", options.source, "Folder of its entry files, which may lie in folders below")
      ->required();
  app.add_option("--include", options.includes,
                 "Folder searched for #include \"...\", besides that of the including file");
  app.add_option("--cache", options.cache, "Folder of compiled stages, kept from run to run")->required();
  app.add_option("--pack", pack, "The pack to write")->required();
  app.add_option("--header", header, "The C++ header to write")->required();
  app.add_option("--depfile", depfile, "Rule of all files read, for the build system");
  app.add_option("--threads", options.threads, "Compiler threads; one per core by default");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    const lumivox::shaderpack::BuildResult result = lumivox::shaderpack::buildPack(options);
    const std::string headerText = generateHeader(result);
    if (!result.warnings.empty()) fmt::print(stderr, "{}", result.warnings);
    lumivox::createParentDirectories(pack);
    lumivox::shader::writeShaderPack(pack, result.pack);
    writeIfChanged(header, headerText);
    if (!depfile.empty()) writeIfChanged(depfile, dependencyRule({pack, header}, result.files));
    std::size_t variants = 0, possible = 0;
    for (const auto& program : result.pack.programs) {
      variants += program.variants.size();
      possible += program.possible;
    }
    fmt::print("{}: compiled {}, reused {} stages; {} of {} variants of {} programs, {} distinct codes\n",
               options.technique, result.compiled, result.reused, variants, possible,
               result.pack.programs.size(), result.pack.codes.size());
    return 0;
  } catch (const lumivox::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  } catch (const std::filesystem::filesystem_error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
