// Where no driver is needed: the order of fences and commands, what becomes of a driver's messages, and what
// a device must have.
#include <fmt/format.h>
#include <lumivox/base/log.h>

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "gpu/driver_messages.h"
#include "gpu/requirements.h"
#include "gpu/uniform_ring.h"
#include "lumivox/shader/pack.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::gpu;
using Catch::Matchers::Contains;

namespace {

/// A device that has done nothing yet: it keeps the order of the commands and fences that it was given.
class RecordedDevice : public UniformRing::Fences {
 public:
  void insert(std::size_t segment) override { fences_[segment] = commands_; }
  void wait(std::size_t segment) override {
    // Before the segment is written again, its fence has to stand behind every command that reads it.
    const auto last = lastReader_.find(segment);
    if (last == lastReader_.end()) return;
    REQUIRE(fences_.count(segment) == 1);
    CHECK(fences_[segment] > last->second);
    ++reused;
    lastReader_.erase(segment);
  }
  /// A command that reads blocks in these segments.
  void command(const std::set<std::size_t>& segments) {
    for (const std::size_t segment : segments) lastReader_[segment] = commands_;
    ++commands_;
  }
  int reused = 0;

 private:
  int commands_ = 0;
  std::map<std::size_t, int> lastReader_, fences_;
};

}  // namespace

TEST_CASE("a segment of uniform blocks is fenced behind the last command that reads it") {
  constexpr std::size_t kAlignment = 16, kSegment = 64;
  RecordedDevice device;
  UniformRing ring(device, kSegment, kAlignment);
  // Commands of 1, 2 and 3 blocks of 16 bytes: they end at every place of a segment of four, so that some do
  // not fit in what is left of one.
  for (int i = 0; i < 200; ++i) {
    const int blocks = 1 + i % 3;
    ring.reserve(static_cast<std::size_t>(blocks) * ring.roomFor(10));
    std::set<std::size_t> segments;
    for (int block = 0; block < blocks; ++block) {
      const std::size_t offset = ring.place(10);
      CHECK(offset % kAlignment == 0);
      segments.insert(offset / kSegment);
    }
    CHECK(segments.size() == 1);
    device.command(segments);
  }
  CHECK(device.reused > 50);
}

TEST_CASE(
    "blocks of one command do not overlap, and its segment tells whether earlier blocks are still in it") {
  RecordedDevice device;
  UniformRing ring(device, 256, 64);
  ring.reserve(ring.roomFor(1) + ring.roomFor(65));
  const std::uint64_t serial = ring.segmentSerial();
  CHECK(ring.place(1) == 0);
  CHECK(ring.place(65) == 64);
  ring.reserve(ring.roomFor(64));
  CHECK(ring.place(64) == 192);
  CHECK(ring.segmentSerial() == serial);
  ring.reserve(ring.roomFor(1));  // the segment is full
  CHECK(ring.segmentSerial() == serial + 1);
  CHECK(ring.place(1) == 256);
}

TEST_CASE("only what the driver calls an error fails, and advice is told once") {
  using Kind = DriverMessages::Kind;
  using Severity = DriverMessages::Severity;
  DriverMessages messages;
  const std::uint64_t before = warningCount();
  for (int i = 0; i < 5; ++i) {
    messages.hear(Kind::advice, Severity::high, 1, 42, fmt::format("buffer {} is in video memory\n", i),
                  "gather");
    messages.hear(Kind::undefinedBehaviour, Severity::low, 1, 43, "the texture has no base level", "gather");
    messages.hear(Kind::advice, Severity::notification, 1, 44, "a note", "");
  }
  CHECK_FALSE(messages.hasErrors());
  CHECK(warningCount() == before + 2);
  // The same number from another source is another piece of advice.
  messages.hear(Kind::advice, Severity::high, 2, 42, "the shader is compiled anew", "gather");
  CHECK(warningCount() == before + 3);

  messages.hear(Kind::error, Severity::high, 1, 7, "GL_INVALID_VALUE in glDispatchCompute\n", "gather");
  messages.hear(Kind::error, Severity::high, 1, 7, "GL_INVALID_VALUE in glDispatchCompute\n", "gather");
  CHECK(messages.takeErrors("running") ==
        "running: the OpenGL driver reports:\n  GL_INVALID_VALUE in glDispatchCompute\n  GL_INVALID_VALUE in "
        "glDispatchCompute");
  CHECK_FALSE(messages.hasErrors());
}

TEST_CASE("a device that lacks something is told apart by the name of every limit that is too low") {
  const auto enough = [](const Requirement& one) { return one.least; };
  CHECK(unmetRequirements(enough).empty());
  for (const Requirement& lacking : requirements()) {
    const std::string unmet = unmetRequirements(
        [&](const Requirement& one) { return one.limit == lacking.limit ? one.least - 1 : one.least; });
    CHECK(unmet == fmt::format("{} is {}, and {} are needed ({})", lacking.name, lacking.least - 1,
                               lacking.least, lacking.why));
  }
  // The limits that OpenGL 4.5 guarantees for vertex shaders (table 23.57), where all geometry is read from
  // storage buffers.
  CHECK_THAT(unmetRequirements([](const Requirement& one) {
               return std::string(one.name) == "GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS" ? 0 : one.least;
             }),
             Contains("GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS is 0"));
}

namespace {

/// The lines that declare what a stage binds, one each.
std::string declarationsOf(const std::string& glsl) {
  std::istringstream lines(glsl);
  std::string declarations;
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("layout(", 0) == 0) declarations += line + "\n";
  return declarations;
}

/// The resources that one stage of a program uses, read from its GLSL, which SPIRV-Cross writes in one form.
std::map<std::string, std::int64_t> usesOf(const std::string& text, Stage stage) {
  const std::string glsl = declarationsOf(text);
  const auto count = [&](const char* pattern) {
    const std::regex expression(pattern);
    return std::distance(std::sregex_iterator(glsl.begin(), glsl.end(), expression), std::sregex_iterator());
  };
  const auto highest = [&](const char* pattern) {
    const std::regex expression(pattern);
    std::int64_t most = -1;
    for (std::sregex_iterator match(glsl.begin(), glsl.end(), expression), end; match != end; ++match)
      most = std::max<std::int64_t>(most, std::stoll((*match)[1]));
    return most + 1;
  };
  const std::int64_t storage = count(R"(std430\) [^;{\n]*buffer )"),
                     images = count(R"(uniform [^;{\n]*[ui]?image[23]D)");
  std::map<std::string, std::int64_t> uses{
      {"GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS", highest(R"(binding = (\d+), std430\))")},
      {"GL_MAX_COMBINED_SHADER_STORAGE_BLOCKS", storage},
      {"GL_MAX_IMAGE_UNITS", highest(R"(layout\(binding = (\d+)[^)]*\) uniform [^;{\n]*[ui]?image[23]D)")},
      {"GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS", highest(R"(layout\(binding = (\d+)\) uniform [ui]?sampler)")}};
  switch (stage) {
    case Stage::vertex:
      uses["GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS"] = storage;
      uses["vertex images"] = images;
      break;
    case Stage::geometry:
      uses["geometry storage"] = storage;
      break;
    case Stage::fragment:
      uses["GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS"] = storage;
      uses["GL_MAX_FRAGMENT_IMAGE_UNIFORMS"] = images;
      break;
    case Stage::compute: {
      uses["GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS"] = storage;
      uses["GL_MAX_COMPUTE_IMAGE_UNIFORMS"] = images;
      uses["GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS"] = count(R"(uniform [ui]?sampler)");
      std::smatch size;
      if (std::regex_search(
              glsl, size, std::regex(R"(local_size_x = (\d+), local_size_y = (\d+), local_size_z = (\d+))")))
        uses["GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS"] =
            std::stoll(size[1]) * std::stoll(size[2]) * std::stoll(size[3]);
      break;
    }
  }
  return uses;
}

}  // namespace

TEST_CASE("no committed shader uses more than a device is asked for at the start") {
  std::map<std::string, std::int64_t> promised{{"vertex images", 0}, {"geometry storage", 0}};
  for (const Requirement& one : requirements()) promised[one.name] = one.least;
  std::size_t stages = 0;
  std::int64_t storage = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::binaryDirectory() / "lib/techniques")) {
    if (entry.path().extension() != ".shaderpack") continue;
    const shader::ShaderPack pack = shader::readShaderPack(entry.path());
    for (const shader::PackedProgram& program : pack.programs) {
      std::set<std::size_t> seen;
      for (const shader::PackedVariant& variant : program.variants) {
        for (const shader::PackedStage& stage : variant.stages) {
          if (!seen.insert(stage.code).second) continue;
          ++stages;
          for (const auto& [limit, uses] : usesOf(pack.codes[stage.code].glsl, stage.stage)) {
            INFO(pack.technique << "/" << program.name << ": " << limit);
            // Of what OpenGL does not promise passes that draw voxels ask DeviceInfo::vertexImages.
            constexpr std::int64_t kDrawnImages = 6;
            if (limit == "vertex images" && program.name.ends_with("_drawn")) {
              CHECK(uses <= kDrawnImages);
              continue;
            }
            CHECK(uses <= promised.at(limit));
            if (limit == "GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS") storage = std::max(storage, uses);
          }
        }
      }
    }
  }
  CHECK(stages > 50);
  CHECK(storage > 4);  // the pattern finds them
}

TEST_CASE("every limit that is asked for at the start is in the documentation, with its number") {
  std::ifstream file(test::sourceDirectory() / "docs/gpu.md");
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  for (const Requirement& one : requirements())
    CHECK_THAT(text, Contains(fmt::format("| `{}` | {} |", one.name, one.least)));
}
