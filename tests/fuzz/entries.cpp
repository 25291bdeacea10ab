#include "fuzz/entries.h"

#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/hash.h"
#include "lumivox/base/image.h"
#include "lumivox/base/log.h"
#include "lumivox/dsl/document.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/scene/scene.h"
#include "lumivox/shader/pack.h"
#include "scene/obj_model.h"
#include "scene/volume_file.h"

namespace lumivox::fuzz {
namespace {

namespace fs = std::filesystem;

/// The files of one process; removed at its end.
class Folder {
 public:
  Folder() {
    // Memory where there is such a folder: a file is written for each of a million inputs.
    const fs::path base = fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
    path_ = base / ("lumivox-fuzz-" + std::to_string(getpid()));
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  fs::path write(const char* name, std::string_view content) const {
    const fs::path file = path_ / name;
    std::FILE* stream = std::fopen(file.c_str(), "wb");
    if (stream == nullptr || std::fwrite(content.data(), 1, content.size(), stream) != content.size() ||
        std::fclose(stream) != 0)
      throw std::runtime_error("cannot write " + file.string());
    return file;
  }

 private:
  fs::path path_;
};

const Folder& folder() {
  static const Folder made;
  return made;
}

void require(bool kept, const char* promise) {
  if (kept) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

/// Laying out is idempotent, and what it makes is a text without findings.
void layOut(const dsl::Document& document) {
  const std::string once = dsl::format(document);
  const dsl::Document again = dsl::parse(once, document.file);
  require(again.findings.empty(), "a text that was laid out parses");
  require(dsl::format(again) == once, "laying out twice is laying out once");
}

/// Runs `work`; an Error is a refusal and good.
template <class Work>
bool taken(Work&& work) {
  try {
    work();
    return true;
  } catch (const Error& refusal) {
    require(*refusal.what() != '\0', "a refusal says why");
    return false;
  }
}

}  // namespace

void sceneText(std::string_view input) {
  const LogCapture silent;
  const fs::path file = folder().write("input.scene", input);
  dsl::Document document = dsl::parse(std::string(input), file);
  if (document.findings.empty()) layOut(document);
  taken([&] { checkScene(file); });
}

void pipelineText(std::string_view input) {
  const LogCapture silent;
  const fs::path file = folder().write("input.pipeline", input);
  const bool good = taken([&] {
    const Pipeline pipeline = Pipeline::parse(std::string(input), file);
    for (const Sweep& sweep : pipeline.sweeps) require(!sweep.points().empty(), "a sweep has points");
    for (const PipelineParameter& parameter : pipeline.parameters)
      require(parameter.misfit(parameter.value).empty(), "a default fits its own declaration");
  });
  if (good) layOut(dsl::parse(std::string(input), file));
}

void objModel(std::string_view input) {
  const LogCapture silent;
  constexpr std::string_view kMaterials = "%%MTL\n";
  const std::size_t split = input.find(kMaterials);
  const fs::path file = folder().write("model.obj", input.substr(0, split));
  folder().write("model.mtl", split == std::string_view::npos ? std::string_view()
                                                              : input.substr(split + kMaterials.size()));
  taken([&] {
    Hasher hasher;
    const Model model = loadModel({file}, {}, hasher);
    require(model.normals.size() == model.positions.size(), "every vertex has a normal");
    for (const std::uint32_t index : model.indices)
      require(index < model.positions.size(), "every index has its vertex");
    for (const ModelObject& object : model.objects)
      for (const Part& part : object.parts)
        require(part.material >= 0 && static_cast<std::size_t>(part.material) < model.materials.size(),
                "every part has its material");
  });
}

void shaderPack(std::string_view input) {
  const LogCapture silent;
  constexpr std::string_view kContent = "%%CONTENT\n";
  std::string pack(input);
  if (input.substr(0, kContent.size()) == kContent) {
    const std::string_view content = input.substr(kContent.size());
    const ContentHash hash = hashOf(content);
    const std::uint64_t size = content.size();
    const std::uint32_t version = 2;
    pack = "LVXSHPK\n";
    pack.append(reinterpret_cast<const char*>(&version), sizeof version);
    pack.append(reinterpret_cast<const char*>(&size), sizeof size);
    pack.append(reinterpret_cast<const char*>(&hash.high), sizeof hash.high);
    pack.append(reinterpret_cast<const char*>(&hash.low), sizeof hash.low);
    pack.append(content);
  }
  const fs::path file = folder().write("input.shaderpack", pack);
  taken([&] {
    const shader::ShaderPack read = shader::readShaderPack(file);
    for (const shader::PackedProgram& program : read.programs) {
      for (const shader::PackedVariant& variant : program.variants) {
        require(program.find({variant.values}) != nullptr, "a variant is found by its key");
        program.text(variant.values);
        for (const shader::PackedStage& stage : variant.stages)
          require(stage.code < read.codes.size(), "every stage has its code");
      }
    }
    for (const shader::PackedCode& code : read.codes) code.spirv();
    const fs::path copy = folder().write("copy.shaderpack", "");
    shader::writeShaderPack(copy, read);
    require(shader::readShaderPack(copy).programs.size() == read.programs.size(),
            "a pack can be written again");
  });
}

void exrImage(std::string_view input) {
  const LogCapture silent;
  const fs::path file = folder().write("input.exr", input);
  taken([&] { readExrAttributes(file); });
  taken([&] {
    const LayeredImage image = readExr(file);
    require(!image.layers.empty(), "an image has layers");
    for (const auto& [name, layer] : image.layers)
      require(layer.width() == image.layers.begin()->second.width() &&
                  layer.height() == image.layers.begin()->second.height(),
              "the layers of an image are of one size");
  });
}

void volumeFile(std::string_view input) {
  const LogCapture silent;
  const fs::path file = folder().write("input.vdb", input);
  taken([&] {
    Hasher hasher;
    const DensityVolume volume = readVolumeFile(file, "", hasher);
    const auto size = glm::u64vec3(volume.resolution);
    require(volume.values.size() == size.x * size.y * size.z && !volume.values.empty(),
            "every voxel has its density");
    require(volume.voxelSize > 0.0, "voxels have an extent");
    for (const float value : volume.values)
      require(std::isfinite(value) && value >= 0.0f, "densities are finite and not negative");
  });
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all{{"scene_text", sceneText}, {"pipeline_text", pipelineText},
                                      {"obj_model", objModel},   {"shader_pack", shaderPack},
                                      {"exr_image", exrImage},   {"volume_file", volumeFile}};
  return all;
}

}  // namespace lumivox::fuzz
