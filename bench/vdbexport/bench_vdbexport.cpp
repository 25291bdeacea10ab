// Export of a radiance grid from the device to the closed file, against OpenVDB alone writing the same sparse
// grids from memory. Both alternate in one run; printed are medians.
// usage: bench_vdbexport [--quick | SCENE [RESOLUTION [REPEATS]]] (default: scenes/arcade.scene 256 9), in
// the project's folder. --quick: a second's work, whose figures mean nothing, for the tests.
#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/command_line.h"
#include "lumivox/base/file.h"
#include "lumivox/measure/metrics.h"
#include "vdbexport/export.h"
#include "vdbexport/texels.h"
#include "vdbexport/vdb_file.h"

namespace {

using namespace lumivox;

double milliseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void printRow(const std::string& what, std::vector<double> times) {
  const TimingStatistics time = statisticsOf(std::move(times));
  fmt::print("{:<44} {:>9.1f} {:>9.1f} {:>9.1f}\n", what, time.median, time.lowerQuartile,
             time.upperQuartile);
}

int run(std::vector<std::string> arguments) {
  if (!arguments.empty() && arguments[0] == "--quick") arguments = {"scenes/cornell.scene", "32", "1"};
  const std::filesystem::path sceneFile = arguments.empty() ? "scenes/arcade.scene" : arguments[0];
  const std::string resolution = arguments.size() > 1 ? arguments[1] : "256";
  const int repeats = arguments.size() > 2 ? std::stoi(arguments[2]) : 9;

  openvdb::initialize();
  const command::GlobalOptions global;
  const Pipeline pipeline = Pipeline::load("scenes/pipelines/voxel_cone_tracing.pipeline");
  RenderOptions options;
  options.parameters = pipeline.settings({"resolution=" + resolution});
  TechniqueSet techniques = global.techniqueSet();
  const Scene scene = global.loadScene(sceneFile);
  const auto device = global.openDevice();
  vdb::Exporter exporter(*device, techniques, scene, pipeline, options, {{"grid.mips"}, {0}, false});
  const auto provenance = command::provenance(global, scene, pipeline, options, *device, 0.0);

  const std::filesystem::path folder = std::filesystem::temp_directory_path();
  const auto ours = folder / fmt::format("bench_vdbexport_{}.vdb", getpid()),
             theirs = folder / fmt::format("bench_openvdb_{}.vdb", getpid());
  std::vector<double> convertMs, writeMs, exportMs, openvdbMs, ratios;
  std::uint64_t deviceBytes = 0, activeVoxels = 0;
  glm::ivec3 size{0};
  for (int repeat = 0; repeat <= repeats; ++repeat) {
    // The passes do not run again, but the fields are new, so that each repeat downloads them.
    std::vector<vdb::NamedField> fields = exporter.render(0.0, 0);
    device->finish();
    openvdb::GridCPtrVec grids;
    const double convert = milliseconds([&] {
      for (const vdb::NamedField& field : fields) grids.push_back(exporter.grid(field, provenance));
    });
    double write = 0.0, alone = 0.0;
    const auto writeOurs = [&] { write = milliseconds([&] { vdb::writeVdb(ours, grids); }); };
    const auto writeTheirs = [&] {
      alone = milliseconds([&] {
        openvdb::io::File file(theirs.string());
        file.write(grids);
        file.close();
      });
    };
    // The second finds the grids in the caches, so they take turns at coming first.
    if (repeat % 2 == 0) writeTheirs();
    writeOurs();
    if (repeat % 2 == 1) writeTheirs();
    deviceBytes = fields.front().field.deviceBytes;
    size = fields.front().field.resolution;
    activeVoxels = grids.front()->activeVoxelCount();
    if (repeat == 0) continue;  // warms up
    convertMs.push_back(convert);
    writeMs.push_back(write);
    exportMs.push_back(convert + write);
    openvdbMs.push_back(alone);
    ratios.push_back((convert + write) / alone);
  }
  const std::uint64_t fileBytes = std::filesystem::file_size(ours);
  std::filesystem::remove(ours);
  std::filesystem::remove(theirs);

  fmt::print("{}: {} x {} x {} voxels, {} of them active; {} repeats\n", sceneFile.filename().string(),
             size.x, size.y, size.z, activeVoxels, repeats);
  fmt::print("{:<44} {:>9} {:>9} {:>9}\n", "ms", "median", "quartile", "quartile");
  printRow("download and conversion", convertMs);
  printRow("encoding and writing the file", writeMs);
  printRow("export, both together", exportMs);
  printRow("OpenVDB alone, writing the same grids", openvdbMs);
  const TimingStatistics ratio = statisticsOf(ratios);
  fmt::print("export / OpenVDB alone: {:.2f} (quartiles {:.2f}, {:.2f}); asked: at most 1.5\n", ratio.median,
             ratio.lowerQuartile, ratio.upperQuartile);
  fmt::print("file {}, dense on the device {}: {:.1f} %\n", formatBytes(fileBytes), formatBytes(deviceBytes),
             100.0 * static_cast<double>(fileBytes) / static_cast<double>(deviceBytes));
  return command::kGood;
}

}  // namespace

int main(int count, char** arguments) {
  return lumivox::command::guarded("bench_vdbexport", [=] {
    return run({arguments + 1, arguments + count});
  });
}
