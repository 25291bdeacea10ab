// new technique: writes a working technique to start from, inside this tree or in a project of its own.
#include <fmt/format.h>

#include "command.h"
#include "lumivox/base/error.h"
#include "lumivox/base/installation.h"
#include "new_technique.h"

namespace lumivox::command {
namespace {

namespace fs = std::filesystem;

/// The project around the working folder; without one, a new folder with the technique's name.
fs::path projectHere(const std::string& name) {
  std::error_code ignored;
  const fs::path here = fs::current_path(ignored);
  for (fs::path folder = here; folder.has_relative_path(); folder = folder.parent_path())
    if (isTechniqueProject(folder)) return folder;
  return here / name;
}

/// The folder that this program was built in, in which find_package finds no Lumivox; nothing if the program
/// is installed.
std::optional<fs::path> buildFolder() {
  const auto program = programFile();
  if (!program) return std::nullopt;
  const fs::path folder = program->parent_path().parent_path();
  std::error_code ignored;
  if (!fs::is_regular_file(folder / "CMakeCache.txt", ignored)) return std::nullopt;
  return folder;
}

/// The prefix of this installation if neither the shell nor find_package searches it.
std::optional<fs::path> unusualPrefix() {
  const auto program = programFile();
  if (!program || !programData("cmake")) return std::nullopt;
  const fs::path prefix = program->parent_path().parent_path();
  if (prefix == "/usr" || prefix == "/usr/local") return std::nullopt;
  return prefix;
}

int newTechniqueCommand(const std::string& name, const fs::path& in, const GlobalOptions& global) {
  if (const std::string defect = nameDefect(name); !defect.empty()) throw Error(defect);
  TechniqueSet techniques = global.techniqueSet();
  for (const std::string& known : techniques.available())
    if (known == name)
      throw Error(fmt::format("there is a technique '{}' already; expected a name that is not taken", name));
  const auto templates = programData("templates");
  if (!templates)
    throw Error("the templates that come with the program are missing; expected share/lumivox/templates");
  const fs::path project = in.empty() ? projectHere(name) : in;
  const bool isTree = fs::is_directory(project / "framework");
  for (const fs::path& file : newTechnique(*templates, name, project))
    if (!global.quiet) print((project / file).lexically_normal().string() + "\n");
  if (global.quiet) return kGood;
  const std::string folder = project.lexically_normal().string();
  if (isTree) {
    print(fmt::format(
        "\nNext, in {}:\n  cmake --preset release && ninja -C build laboratory {}_tests\n"
        "  build/bin/{}_tests\n"
        "  build/bin/lumivox render scenes/cornell.scene scenes/pipelines/{}.pipeline -o out/{}.png\n",
        folder, name, name, name, name));
    return kGood;
  }
  const auto built = buildFolder();
  const auto prefix = built ? std::optional(*built / "installed") : unusualPrefix();
  if (built)
    print(fmt::format(
        "\nFirst install this Lumivox, since a project outside of its tree needs the headers and the package:\n"
        "  ninja -C {} sdk && cmake --install {} --prefix {}\n",
        built->string(), built->string(), prefix->string()));
  print(fmt::format(
      "\nNext, in {}:\n  cmake -S . -B build -G Ninja{} && cmake --build build\n"
      "  ctest --test-dir build --output-on-failure\n"
      "  {} render {}/cornell.scene scenes/pipelines/{}.pipeline --techniques build/lib/techniques -o out/{}.png\n",
      folder, prefix ? " -DCMAKE_PREFIX_PATH=" + prefix->string() : "",
      prefix ? (*prefix / "bin/lumivox").string() : "lumivox",
      programData("scenes").value_or("scenes").string(), name, name));
  return kGood;
}

}  // namespace

void addNewCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand("new", "writes a starting point");
  command->require_subcommand(1);
  command->fallthrough();
  auto* technique = command->add_subcommand(
      "technique", "a working technique: C++, shader, paper card, pipeline and test, to be built at once");
  auto name = std::make_shared<std::string>();
  auto in = std::make_shared<fs::path>();
  technique->add_option("NAME", *name, "name of the technique, such as my_paper")->required();
  technique->add_option(
      "--in", *in,
      "the project to which it is added, made if it is missing (default: the project around the working folder, else a new folder NAME)");
  const GlobalOptions& global = commands.global;
  commands.onChosen(technique, [=, &global] { return newTechniqueCommand(*name, *in, global); });
}

}  // namespace lumivox::command
