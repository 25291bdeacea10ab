// Every seed of the fuzzers, and everything that they ever found, through the same doors.
#include <algorithm>
#include <filesystem>

#include "fuzz/entries.h"
#include "lumivox/base/file.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

std::size_t runAll(const std::string& entryName, void (*run)(std::string_view)) {
  std::size_t files = 0;
  for (const char* kind : {"seeds", "findings"}) {
    const std::filesystem::path folder = sourceDirectory() / "tests/fuzz" / kind / entryName;
    if (!std::filesystem::exists(folder)) continue;
    for (const auto& file : std::filesystem::directory_iterator(folder)) {
      INFO(file.path().filename());
      CHECK_NOTHROW(run(readFile(file.path())));
      ++files;
    }
  }
  return files;
}

}  // namespace

TEST_CASE("every seed and every past finding of the fuzzers is taken or refused with a message") {
  for (const fuzz::Entry& entry : fuzz::entries()) {
    INFO(entry.name);
    CHECK(runAll(entry.name, entry.run) >= 3);
  }
  // The folders of seeds are the list from which fuzzers are built and run.
  const auto hasEntry = [](const std::string& name) {
    return std::any_of(fuzz::entries().begin(), fuzz::entries().end(),
                       [&](const fuzz::Entry& entry) { return entry.name == name; });
  };
  for (const auto& folder : std::filesystem::directory_iterator(sourceDirectory() / "tests/fuzz/seeds")) {
    INFO(folder.path().filename());
    CHECK(hasEntry(folder.path().filename().string()));
  }
}

TEST_CASE("every committed scene and pipeline goes through the doors of the fuzzers") {
  std::size_t files = 0;
  for (const auto& file : std::filesystem::recursive_directory_iterator(sourceDirectory() / "scenes")) {
    INFO(file.path());
    if (file.path().extension() == ".scene") CHECK_NOTHROW(fuzz::sceneText(readFile(file.path())));
    if (file.path().extension() == ".pipeline") CHECK_NOTHROW(fuzz::pipelineText(readFile(file.path())));
    ++files;
  }
  CHECK(files > 30);
}

TEST_CASE("a text cut off at any byte or with any byte changed is taken or refused with a message") {
  const std::string scene = readFile(sourceDirectory() / "scenes/fog.scene");
  const std::string pipeline = readFile(sourceDirectory() / "scenes/pipelines/voxel_cone_tracing.pipeline");
  for (std::size_t i = 0; i < scene.size(); i += 7) {
    CHECK_NOTHROW(fuzz::sceneText(scene.substr(0, i)));
    std::string changed = scene;
    changed[i] = static_cast<char>(changed[i] ^ 0x15);
    CHECK_NOTHROW(fuzz::sceneText(changed));
  }
  for (std::size_t i = 0; i < pipeline.size(); i += 7) {
    CHECK_NOTHROW(fuzz::pipelineText(pipeline.substr(0, i)));
    std::string changed = pipeline;
    changed[i] = static_cast<char>(changed[i] ^ 0x15);
    CHECK_NOTHROW(fuzz::pipelineText(changed));
  }
}

TEST_CASE("a model cut off at any byte or with any byte changed is taken or refused with a message") {
  const auto goThrough = [](const std::string& model, std::size_t step, void (*run)(std::string_view)) {
    for (std::size_t i = 0; i < model.size(); i += step) {
      CHECK_NOTHROW(run(model.substr(0, i)));
      for (const int change : {0x15, 0x80, 0x01}) {
        std::string changed = model;
        changed[i] = static_cast<char>(changed[i] ^ change);
        CHECK_NOTHROW(run(changed));
      }
    }
  };
  const std::filesystem::path seeds = sourceDirectory() / "tests/fuzz/seeds";
  for (const auto& file : std::filesystem::directory_iterator(seeds / "gltf_model"))
    goThrough(readFile(file.path()), 3, fuzz::gltfModel);
  for (const auto& file : std::filesystem::directory_iterator(seeds / "ply_model"))
    goThrough(readFile(file.path()), 3, fuzz::plyModel);
  goThrough(readFile(sourceDirectory() / "scenes/models/moving_shapes.glb"), 61, fuzz::gltfModel);
}
