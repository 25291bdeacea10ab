// vdbexport: writes the voxel grids of a pipeline to OpenVDB files, and lists and compares such files.
#include "common/command_line.h"
#include "common/manual.h"
#include "lumivox/plugin/technique.h"
#include "vdbexport/commands.h"

namespace {

using namespace lumivox;
using namespace lumivox::command;

int run(int count, char** arguments) {
  requireLibraryOf(techniqueVersionHere());
  CLI::App app{
      "Exports the voxel grids of a pipeline as OpenVDB files; lists what can be exported and what a file "
      "holds; compares two files."};
  app.name("vdbexport");
  app.set_version_flag("--version", std::string("vdbexport ") + LUMIVOX_VERSION);
  app.option_defaults()->always_capture_default(false);

  GlobalOptions global;
  global.commandLine = asTyped("vdbexport", count, arguments);
  global.addTo(app);
  vdb::Options options;
  options.addTo(app);
  addDescriptionOptions(app, LUMIVOX_VERSION);
  if (const auto done = parseOptions(app, global, count, arguments)) return *done;
  if (options.list) return vdb::list(options, global);
  if (options.diff) return vdb::diff(options, global);
  return vdb::exportGrids(options, global);
}

}  // namespace

int main(int count, char** arguments) {
  return lumivox::command::guarded("vdbexport", [=] { return run(count, arguments); });
}
