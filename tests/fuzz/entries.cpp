#include "fuzz/entries.h"

#include <unistd.h>

#include <algorithm>
#include <array>
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
#include "lumivox/scene/model_animation.h"
#include "lumivox/scene/scene.h"
#include "lumivox/shader/pack.h"
#include "scene/model.h"
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
  const fs::path& path() const { return path_; }
  fs::path write(const std::string& name, std::string_view content) const {
    const fs::path file = path_ / name;
    fs::create_directories(file.parent_path());
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

/// Loads a model and looks at everything that it promises, also while it moves.
void loadAndCheck(const fs::path& file) {
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
    for (const ModelObject& object : model.objects) {
      require(object.firstVertex + object.vertexCount <= model.positions.size(),
              "objects have their vertices");
      if (object.animation == nullptr) continue;
      for (const double time : {-1.0, 0.0, 0.3, 1e9}) {
        object.animation->placementAt(time);
        if (!object.animation->deforms()) continue;
        std::vector<glm::vec3> positions, normals;
        object.animation->deform(time, positions, normals);
        require(positions.size() == object.vertexCount && normals.size() == object.vertexCount,
                "every vertex has its place at every time");
      }
    }
  });
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
  loadAndCheck(file);
}

void gltfModel(std::string_view input) {
  const LogCapture silent;
  constexpr std::string_view kBinary = "%%BIN\n";
  const std::size_t split = input.find(kBinary);
  folder().write("model.bin",
                 split == std::string_view::npos ? std::string_view() : input.substr(split + kBinary.size()));
  loadAndCheck(folder().write("model.gltf", input.substr(0, split)));
}

void plyModel(std::string_view input) {
  const LogCapture silent;
  loadAndCheck(folder().write("model.ply", input));
}

void shaderPack(std::string_view input) {
  const LogCapture silent;
  constexpr std::string_view kContent = "%%CONTENT\n";
  std::string pack(input);
  if (input.substr(0, kContent.size()) == kContent) {
    const std::string_view content = input.substr(kContent.size());
    const ContentHash hash = hashOf(content);
    const std::uint64_t size = content.size();
    const std::uint32_t version = shader::kPackVersion;
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

void hdrImage(std::string_view input) {
  const LogCapture silent;
  const fs::path file = folder().write("input.hdr", input);
  taken([&] {
    const ImageBuffer image = readHdr(file, kMostEnvironmentTexels);
    require(image.channels() == 3 && image.pixelCount() > 0, "an image has colours");
  });
  const fs::path scene = folder().write(
      "hdr.scene", "scene \"s\" { camera m { eye 0 0 1 target 0 0 0 } environment { file \"input.hdr\" } }");
  taken([&] {
    const Scene loaded = loadScene(scene);
    for (int c = 0; c < 3; ++c)
      require(std::isfinite(loaded.environment[c]) && loaded.environment[c] >= 0.0f,
              "the mean of a map is finite and not negative");
    if (loaded.environmentMap == nullptr) return;
    for (const glm::vec3 towards : {glm::vec3(0, 1, 0), glm::vec3(0, -1, 0), glm::vec3(1, 0, 1e-6f)})
      require(loaded.environmentMap->texelTowards(towards) < loaded.environmentMap->radiance.size(),
              "every direction has its texel");
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

namespace {

constexpr std::array kTexts{"tum/associations.txt",
                            "tum/rgb.txt",
                            "tum/depth.txt",
                            "tum/groundtruth.txt",
                            "frames/frame-000000.pose.txt",
                            "frames/frame-000001.pose.txt",
                            "redwood/trajectory.log",
                            "exr/groundtruth.txt"};

/// Two frames of 4 x 3 pixels in each layout.
void makePictures() {
  const WordImage depth{4, 3, {0, 900, 1000, 1100, 1000, 65535, 1000, 2000, 1, 1000, 1000, 1000}};
  ByteImage colour{4, 3, 3, {}};
  for (int i = 0; i < 36; ++i) colour.values.push_back(static_cast<unsigned char>(7 * i));
  LayeredImage floats;
  floats.layers[""] = ImageBuffer(4, 3, 3, 0.5f);
  floats.layers["Z"] = ImageBuffer(4, 3, 1, 1.5f);
  const fs::path& here = folder().path();
  for (const char* name : {"tum/rgb", "tum/depth", "frames", "redwood/color", "redwood/depth", "exr"})
    fs::create_directories(here / name);
  for (const char number : {'0', '1'}) {
    const std::string padded = std::string("00000") + number;
    writeBytePng(here / "tum/rgb" / (padded + ".png"), colour);
    writeGreyPng16(here / "tum/depth" / (padded + ".png"), depth);
    writeBytePng(here / ("frames/frame-" + padded + ".color.png"), colour);
    writeGreyPng16(here / ("frames/frame-" + padded + ".depth.png"), depth);
    writeBytePng(here / "redwood/color" / (padded + ".png"), colour);
    writeGreyPng16(here / "redwood/depth" / (padded + ".png"), depth);
    writeExr(here / ("exr/room_" + padded + ".exr"), floats);
  }
}

/// Loads a scene with a capture, and decodes its first and last frame. A check of the text takes what loading
/// takes.
void loadCaptureScene(const std::string& inside) {
  const fs::path file = folder().write(
      "capture.scene", "scene \"s\" { camera m { capture c }\n capture c {\n" + inside + "\n} }");
  Scene scene;
  const bool isLoaded = taken([&] { scene = loadScene(file); });
  require(taken([&] { checkScene(file); }) == isLoaded, "a check takes what loading takes");
  if (!isLoaded) return;
  taken([&] {
    require(scene.captures.size() == 1, "a scene with a capture has one");
    const Capture& capture = *scene.captures.front();
    require(!capture.frames.empty(), "a capture has frames");
    require(capture.camera.width > 0 && capture.camera.height > 0, "pictures have pixels");
    for (const CaptureFrame& frame : capture.frames) {
      require(std::isfinite(frame.time), "times are finite");
      require(std::abs(glm::length(frame.rotation) - 1.0) < 1e-6, "rotations have unit length");
      require(std::isfinite(glm::dot(frame.eye, frame.eye)), "eyes are in finite places");
    }
    for (std::size_t i = 1; i < capture.frames.size(); ++i)
      require(capture.frames[i - 1].time <= capture.frames[i].time, "frames are in the order of their times");
    for (const double time : {-1.0, 0.0, 1e9}) {
      const SceneSnapshot snapshot = snapshotOf(scene, time);
      const glm::vec3 corner = snapshot.camera.direction(0.0f, 0.0f);
      require(std::isfinite(glm::dot(corner, corner)), "views are finite");
    }
    for (const std::size_t frame : {std::size_t{0}, capture.frames.size() - 1}) {
      taken([&] {
        const auto image = capture.image(frame);
        const std::size_t pixels =
            static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height);
        require(image->depth.size() == pixels && image->colour.size() == 3 * pixels,
                "every pixel has a depth and a colour");
        for (const float depth : image->depth)
          require(std::isfinite(depth) && depth >= 0.0f, "depths are finite and not negative");
      });
    }
  });
}

}  // namespace

void captureTexts(std::string_view input) {
  const LogCapture silent;
  static const bool made = (makePictures(), true);
  require(made, "pictures can be written");
  constexpr std::string_view kFile = "%%FILE ";
  for (const char* text : kTexts) fs::remove(folder().path() / text);
  std::size_t next = input.find(kFile);
  const std::string inside(input.substr(0, next));
  while (next != std::string_view::npos) {
    input.remove_prefix(next + kFile.size());
    next = input.find(kFile);
    const std::string_view part = input.substr(0, next);
    const std::size_t lineEnd = std::min(part.find('\n'), part.size());
    for (const char* text : kTexts)
      if (part.substr(0, lineEnd) == text)
        folder().write(text, part.substr(std::min(lineEnd + 1, part.size())));
  }
  loadCaptureScene(inside);
}

void sensFile(std::string_view input) {
  const LogCapture silent;
  folder().write("input.sens", input);
  loadCaptureScene("file \"input.sens\"");
}

void depthPng(std::string_view input) {
  const LogCapture silent;
  taken([&] {
    const WordImage image = decodeGreyPng16(std::string(input), "input.png");
    require(image.width > 0 && image.height > 0, "an image has pixels");
    require(
        image.values.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
        "every pixel has its value");
    const fs::path copy = folder().write("copy.png", "");
    writeGreyPng16(copy, image);
    require(decodeGreyPng16(readFile(copy), copy).values == image.values, "an image can be written again");
  });
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all{
      {"scene_text", sceneText},       {"pipeline_text", pipelineText}, {"obj_model", objModel},
      {"gltf_model", gltfModel},       {"ply_model", plyModel},         {"shader_pack", shaderPack},
      {"exr_image", exrImage},         {"hdr_image", hdrImage},         {"volume_file", volumeFile},
      {"capture_texts", captureTexts}, {"sens_file", sensFile},         {"depth_png", depthPng}};
  return all;
}

}  // namespace lumivox::fuzz
