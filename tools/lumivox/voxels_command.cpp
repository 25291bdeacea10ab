// voxels: measures every voxelizer on a scene: time, memory and the voxels that its grid gets wrong.
#include <fmt/format.h>

#include <charconv>

#include "command.h"
#include "common/named_texts.h"
#include "common/outputs.h"
#include "lumivox/analysis/scaling.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/interruption.h"
#include "lumivox/experiment/report.h"
#include "lumivox/experiment/voxelizers.h"
#include "lumivox/page/voxel_page.h"
#include "lumivox/results/text.h"
#include "measure_options.h"

namespace lumivox::command {
namespace {

struct VoxelsCommand {
  std::vector<std::filesystem::path> scenes;
  VoxelizerOptions options;
  std::vector<std::string> resolutions;
  std::string image;
  std::filesystem::path output;
  std::optional<int> repeats;
  bool scaling = false, noSweep = false, json = false;
};

/// Resolutions from texts such as "64" and "32,64,128".
std::vector<int> resolutionsOf(const std::vector<std::string>& texts) {
  std::vector<int> resolutions;
  for (const std::string& text : texts)
    for (std::size_t start = 0; start <= text.size();) {
      const std::size_t end = std::min(text.find(',', start), text.size());
      int value = 0;
      const auto read = std::from_chars(text.data() + start, text.data() + end, value);
      if (read.ec != std::errc() || read.ptr != text.data() + end)
        throw Error(fmt::format(
            "--resolution '{}': expected voxels along the longest side, such as 64 or 32,64,128", text));
      resolutions.push_back(value);
      start = end + 1;
    }
  return resolutions;
}

std::string percentText(double share) {
  return fmt::format("{:.3f}", 100.0 * share);
}

void printTable(const std::vector<VoxelizerRecord>& records) {
  std::vector<std::vector<std::string>> rows{{"voxelizer", "res", "triangles", "ms", "quartiles", "fragments",
                                              "occupied", "recall", "precision", "axis holes %",
                                              "oblique holes %", "output", "B/voxel", "memory"}};
  std::string skipped;
  for (const VoxelizerRecord& record : records) {
    if (!record.whyNot.empty()) {
      skipped += fmt::format("not measured: {}, resolution {}: {}\n", record.label(), record.resolution,
                             record.whyNot);
      continue;
    }
    rows.push_back({record.label(), std::to_string(record.resolution), std::to_string(record.triangles),
                    formatMilliseconds(record.frameMs.median),
                    record.frameMs.repeats < kLeastRepeats ? "-" : formatQuartiles(record.frameMs),
                    record.fragments == 0 ? "-" : std::to_string(record.fragments),
                    std::to_string(record.occupied), fmt::format("{:.4f}", record.error.recall()),
                    fmt::format("{:.4f}", record.error.precision()), percentText(record.holes.axisShare()),
                    percentText(record.holes.obliqueShare()), formatBytes(record.bytes),
                    threeDigits(record.bytesPerVoxel()), formatBytes(record.allocatedBytes)});
  }
  std::string text = records.empty() ? "" : records.front().scene + "\n";
  if (rows.size() > 1) text += textTable(rows, 2);
  for (const VoxelizerScaling& scaling : scalingOf(records)) {
    if (scaling.withResolution)
      text +=
          fmt::format("{}: time ~ (voxels along a side)^{:.2f}\n", scaling.label, *scaling.withResolution);
    if (scaling.withTriangles)
      text += fmt::format("{}: time ~ triangles^{:.2f}\n", scaling.label, *scaling.withTriangles);
  }
  print(text + remarks(skipped));
}

int voxels(const VoxelsCommand& command, const GlobalOptions& global) {
  constexpr int kScalingSubdivisions = 2;  // 4 and 16 times the triangles
  VoxelizerOptions options = command.options;
  if (!command.resolutions.empty()) options.resolutions = resolutionsOf(command.resolutions);
  if (!command.image.empty())
    std::tie(options.width, options.height) = parseResolution(command.image, "--image");
  if (command.repeats) options.repeats = options.repeatsOfLongFrames = *command.repeats;
  options.openSweeps = !command.noSweep;
  if (command.scaling) options.subdivisions = kScalingSubdivisions;
  const VoxelizerFiles files = voxelizerFiles(command.output);
  if (!command.output.empty()) {
    std::vector<std::filesystem::path> inputs = command.scenes;
    inputs.insert(inputs.end(), options.pipelines.begin(), options.pipelines.end());
    Outputs()
        .add("-o", files.page, {".html"})
        .add("-o", files.csv, {".csv"})
        .add("-o", files.json, {".json"})
        .check(inputs);
  }

  TechniqueSet techniques = global.techniqueSet();
  const auto device = global.openDevice();
  std::vector<VoxelizerRecord> all;
  InterruptionNote note;
  note.say("interrupted: measurements of voxelizers are kept only when all are done; from the start: " +
           global.commandLine);
  for (const std::filesystem::path& file : command.scenes) {
    options.progress = progressLine("voxelizers on " + stem(file.string()), "steps");
    const std::vector<VoxelizerRecord> records =
        measureVoxelizers(*device, techniques, global.loadScene(file), options);
    options.progress = {};
    if (!command.json) printTable(records);
    all.insert(all.end(), records.begin(), records.end());
  }
  if (command.json) print(voxelizersJson(all, device->info(), global.commandLine));
  if (!command.output.empty()) {
    writeVoxelizers(files, all, device->info(), global.commandLine);
    if (!command.json) print(files.page.string() + "\n");
  }
  const bool any = std::any_of(all.begin(), all.end(),
                               [](const VoxelizerRecord& record) { return record.whyNot.empty(); });
  return any ? kGood : kNotGood;
}

}  // namespace

void addVoxelsCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "voxels", "measures voxelizers on scenes: time, memory, precision, recall and holes");
  auto all = std::make_shared<VoxelsCommand>();
  VoxelizerOptions& options = all->options;
  takesNames(command->add_option("SCENE", all->scenes, "the scenes' texts or names")->required(),
             NamedText::scene);
  addRepeatable(*command, "--resolution", all->resolutions,
                "voxels along the longest side, 1..1024; several as 32,64,128 (default 64)");
  takesNames(addRepeatable(*command, "--pipeline,--pipelines", options.pipelines,
                           "a pipeline's text or name, or a folder of texts; may be repeated (default: the "
                           "committed voxelizers)"),
             NamedText::pipeline);
  addRepeatable(*command, "--set", options.settings,
                "a parameter, as name=value, of those pipelines that have it");
  command
      ->add_option("--repeats", all->repeats,
                   "timed frames per voxelizer (default 5, and 3 of frames longer than 0.2 s)")
      ->check(CLI::Range(1, 10000));
  command->add_flag("--no-sweep", all->noSweep,
                    "only the default parameters, not the points of the pipelines' sweeps");
  command->add_flag("--scaling", all->scaling,
                    "measure again with every triangle split into 4 and 16: how time grows with triangles");
  command->add_option("--image", all->image,
                      "size of the image for voxelizers that start from one (default: the camera's)");
  command->add_option("--camera", options.camera, "the scene's camera of this name (default: the first)");
  addTime(*command, options.time);
  addSeed(*command, options.seed);
  command->add_option("-o,--out", all->output, "a folder for index.html, voxels.csv and voxels.json");
  command->add_flag("--json", all->json, "print the JSON in place of the table");
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] { return voxels(*all, global); });
}

}  // namespace lumivox::command
