// The law of leaving out: it changes the cost, never the picture. Over every committed scene and pipeline.
#include <algorithm>
#include <regex>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

std::vector<std::filesystem::path> filesIn(const char* folder, const char* extension) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(sourceDirectory() / folder)) {
    if (entry.path().extension() == extension) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Small pictures and grids: the law does not depend on the size, and the software rasteriser has two cores.
RenderOptions smallOptions(const Pipeline& pipeline) {
  RenderOptions options;
  options.width = 48;
  options.height = 32;
  for (const PipelineParameter& parameter : pipeline.parameters) {
    if (parameter.name == "resolution") options.parameters["resolution"].number = 32;
    if (parameter.name == "area_samples") options.parameters["area_samples"].number = 4;
  }
  return options;
}

void checkSamePicture(const std::filesystem::path& sceneFile) {
  Scene scene;
  try {
    scene = loadScene(sceneFile);
  } catch (const AbsentError& absent) {
    skip(absent.what());
    return;
  }
  for (const auto& pipelineFile : filesIn("scenes/pipelines", ".pipeline")) {
    const Pipeline text = Pipeline::load(pipelineFile);
    RenderOptions options = smallOptions(text);
    const FrameResult pruned = renderOnce(scene, text, options);
    options.keepEverything = true;
    const FrameResult whole = renderOnce(scene, text, options);
    REQUIRE(!pruned.outputs.empty());
    REQUIRE(pruned.outputs.size() == whole.outputs.size());
    for (const auto& [name, picture] : pruned.outputs) {
      const std::vector<float>& other = whole.outputs.at(name).values();
      std::size_t different = 0;
      for (std::size_t i = 0; i < other.size(); ++i) different += picture.values()[i] != other[i];
      INFO(sceneFile.filename() << " through " << pipelineFile.filename() << ", output " << name << ": "
                                << different << " values differ");
      CHECK(different == 0);
    }
  }
}

/// Scenes whose models lie beside them in the tree, or those that need models from elsewhere.
std::vector<std::filesystem::path> scenes(bool ownModels) {
  static const std::regex modelFile("file\\s+\"([^\"]+)\"");
  std::vector<std::filesystem::path> files;
  for (const auto& file : filesIn("scenes", ".scene")) {
    const std::string text = readFile(file);
    bool own = true;
    for (std::sregex_iterator match(text.begin(), text.end(), modelFile), end; match != end; ++match) {
      own = own && std::filesystem::exists(file.parent_path() / (*match)[1].str());
    }
    if (own == ownModels) files.push_back(file);
  }
  return files;
}

}  // namespace

TEST_CASE("leaving out passes and variants gives the bit-identical picture on every scene made here") {
  const auto files = scenes(true);
  REQUIRE(files.size() >= 6);
  for (const auto& file : files) checkSamePicture(file);
}

TEST_CASE("leaving out passes and variants gives the bit-identical picture on the well-known models") {
  for (const auto& file : scenes(false)) checkSamePicture(file);
}

TEST_CASE("the same picture comes from SPIR-V and from the GLSL text made of it") {
  const Scene scene = loadScene(sourceDirectory() / "scenes/cornell_glossy.scene");
  const Pipeline text = pipeline("voxel_cone_tracing");
  const RenderOptions options = smallOptions(text);
  std::map<std::string, Picture> pictures[2];
  for (int route = 0; route < 2; ++route) {
    gpu::DeviceOptions deviceOptions;
    deviceOptions.shaderInput = route == 0 ? gpu::ShaderInput::spirv : gpu::ShaderInput::glsl;
    gpu::Device device(deviceOptions);
    pictures[route] = PipelineExecutor(device, techniques(), scene, text, options).render(0.0).outputs;
  }
  for (const auto& [name, picture] : pictures[0]) {
    const Picture& other = pictures[1].at(name);
    REQUIRE(picture.sameShape(other));
    for (std::size_t i = 0; i < picture.values().size(); ++i) {
      CHECK(other.values()[i] == Approx(picture.values()[i]).epsilon(1e-4).margin(1e-6));
    }
  }
}
