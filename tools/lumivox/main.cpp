// lumivox: the command line of the laboratory.
#include <fmt/format.h>

#include <exception>
#include <iostream>

#include "command.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/report/report.h"

namespace {

using namespace lumivox;
using namespace lumivox::command;

std::string asTyped(int count, char** arguments) {
  std::string line;
  for (int i = 0; i < count; ++i) {
    const std::string argument = i == 0 ? "lumivox" : arguments[i];
    const bool plain =
        !argument.empty() && argument.find_first_of(" \t\n'\"\\$`*?#&|;<>(){}[]!~") == std::string::npos;
    line += (i == 0 ? "" : " ") + (plain ? argument : "'" + argument + "'");
  }
  return line;
}

void addGlobalOptions(CLI::App& app, GlobalOptions& global) {
  addRepeatable(app, "--assets", global.assets,
                "a folder to seek models in; then $LUMIVOX_ASSETS, then ../shared/models beside the project; "
                "may be repeated");
  addRepeatable(app, "--techniques", global.techniques,
                "a folder to seek technique libraries in; may be repeated");
  app.add_option("--device", global.device, "auto, software, surfaceless, or the number of an EGL device");
  app.add_option("--shaders", global.shaders, "how programs reach the driver: spirv, glsl or auto")
      ->check(CLI::IsMember({"auto", "spirv", "glsl"}));
  app.add_flag("--strict", global.strict, "refuse what would otherwise be dropped with a warning");
  auto* quiet = app.add_flag("-q,--quiet", global.quiet, "no progress, no messages but errors");
  app.add_flag("-v,--verbose", global.verbose, "more messages")->excludes(quiet);
}

int run(int count, char** arguments) {
  CLI::App app{
      "A laboratory for real-time global illumination: a scene and a pipeline in; pictures, their error and "
      "their time out."};
  app.name("lumivox");
  app.set_version_flag("--version", std::string("lumivox ") + LUMIVOX_VERSION);
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default(false);

  GlobalOptions global;
  global.commandLine = asTyped(count, arguments);
  addGlobalOptions(app, global);
  Commands commands{app, global, {}};
  addTextCommands(commands);
  addListCommand(commands);
  addRenderCommand(commands);
  addReferenceCommand(commands);
  addCompareCommand(commands);
  addReportCommand(commands);
  addExplainCommand(commands);
  addShadersCommand(commands);

  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    // Help and version are no errors; everything else about the options is bad input.
    return app.exit(error, std::cout, std::cerr) == 0 ? kGood : kBadInput;
  }
  setLogLevel(global.quiet ? LogLevel::quiet : global.verbose ? LogLevel::details : LogLevel::information);
  return commands.chosen();
}

}  // namespace

int main(int count, char** arguments) {
  try {
    return run(count, arguments);
  } catch (const lumivox::DiagnosticsError& error) {
    std::cerr << error.what() << std::endl;
  } catch (const lumivox::Error& error) {
    std::cerr << "lumivox: " << error.what() << std::endl;
  } catch (const std::bad_alloc&) {
    std::cerr << "lumivox: out of memory" << std::endl;
  } catch (const std::exception& error) {
    std::cerr << "lumivox: " << error.what() << std::endl;
  }
  return lumivox::command::kBadInput;
}
