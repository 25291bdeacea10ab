// What a device must have: every limit that the shaders of the packs come near to is asked for at the start
// and documented. No driver is needed.
#include <fmt/format.h>

#include <fstream>
#include <map>
#include <numeric>
#include <regex>
#include <set>
#include <spirv-tools/libspirv.hpp>
#include <spirv/unified1/spirv.hpp>
#include <sstream>

#include "gpu/counters.h"
#include "gpu/requirements.h"
#include "lumivox/shader/pack.h"
#include "shader/arithmetic.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::gpu;
using lumivox::test::Tells;

TEST_CASE("a device that lacks something is told apart by the name of every limit that is too low") {
  const auto enough = [](const Requirement& one) { return one.least; };
  CHECK(unmetRequirements(enough).empty());
  for (const Requirement& lacking : requirements()) {
    const std::string unmet = unmetRequirements([&](const Requirement& one) {
      return std::string(one.name) == lacking.name ? one.least - 1 : one.least;
    });
    CHECK(unmet == fmt::format("{} is {}, and {} are needed ({})", lacking.name, lacking.least - 1,
                               lacking.least, lacking.why));
  }
  // The limits that OpenGL 4.5 guarantees for vertex shaders (table 23.57), where all geometry is read from
  // storage buffers.
  CHECK_THAT(unmetRequirements([](const Requirement& one) {
               return std::string(one.name) == "GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS" ? 0 : one.least;
             }),
             Tells("GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS", 0));
}

namespace {

using Uses = std::map<std::string, std::int64_t>;

/// The lines that declare what a stage binds, one each.
std::string declarationsOf(const std::string& glsl) {
  std::istringstream lines(glsl);
  std::string declarations;
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("layout(", 0) == 0) declarations += line + "\n";
  return declarations;
}

/// Bytes that a work group shares: of all variables of that storage class, a vector of three as one of four.
std::int64_t sharedBytesOf(const std::vector<std::uint32_t>& spirv) {
  std::map<std::uint32_t, std::int64_t> sizes, constants;  // of types and of constants, by id
  std::map<std::uint32_t, std::uint32_t> pointees;
  std::int64_t bytes = 0;
  for (std::size_t at = 5; at < spirv.size(); at += spirv[at] >> 16) {
    const std::uint32_t* w = &spirv[at + 1];
    const std::size_t operands = (spirv[at] >> 16) - 1;
    switch (static_cast<spv::Op>(spirv[at] & 0xffffu)) {
      case spv::OpTypeBool:
      case spv::OpTypeInt:
      case spv::OpTypeFloat:
        sizes[w[0]] = 4;
        break;
      case spv::OpTypeVector:
        sizes[w[0]] = w[2] == 2 ? 8 : 16;
        break;
      case spv::OpTypeMatrix:
        sizes[w[0]] = sizes[w[1]] * w[2];
        break;
      case spv::OpConstant:
      case spv::OpSpecConstant:
        constants[w[1]] = w[2];
        break;
      case spv::OpTypeArray:
        // Its length could be an expression of specialisation constants, which nobody has used yet.
        sizes[w[0]] = sizes[w[1]] * constants.at(w[2]);
        break;
      case spv::OpTypeStruct:
        sizes[w[0]] = std::accumulate(w + 1, w + operands, std::int64_t{0},
                                      [&](std::int64_t sum, std::uint32_t id) { return sum + sizes[id]; });
        break;
      case spv::OpTypePointer:
        pointees[w[0]] = w[2];
        break;
      case spv::OpVariable:
        if (w[2] == spv::StorageClassWorkgroup) bytes += sizes.at(pointees.at(w[0]));
        break;
      default:
        break;
    }
  }
  return bytes;
}

/// What one stage of a program uses, read from its GLSL, which SPIRV-Cross writes in one form: by the name of
/// the limit. Those of a whole program are what this stage adds to it.
Uses usesOf(const shader::PackedCode& code, Stage stage) {
  const std::string glsl = declarationsOf(code.glsl());
  const auto count = [&](const char* pattern) {
    const std::regex expression(pattern);
    return std::distance(std::sregex_iterator(glsl.begin(), glsl.end(), expression), std::sregex_iterator());
  };
  /// The same of what may be declared as an array, which counts as many times as it is long.
  const auto countElements = [&](const char* pattern) {
    const std::regex expression(std::string(pattern) + R"([^;\n]*;)"), length(R"(\[(\d+)\])");
    std::int64_t sum = 0;
    for (std::sregex_iterator match(glsl.begin(), glsl.end(), expression), end; match != end; ++match) {
      const std::string declared = match->str();
      std::int64_t elements = 1;
      for (std::sregex_iterator one(declared.begin(), declared.end(), length); one != end; ++one)
        elements *= std::stoll((*one)[1]);
      sum += elements;
    }
    return sum;
  };
  const auto highest = [&](const char* pattern) {
    const std::regex expression(pattern);
    std::int64_t most = -1;
    for (std::sregex_iterator match(glsl.begin(), glsl.end(), expression), end; match != end; ++match)
      most = std::max<std::int64_t>(most, std::stoll((*match)[1]));
    return most + 1;
  };
  const std::int64_t storage = count(R"(std430\) [^;{\n]*buffer )"),
                     images = countElements(R"(uniform [^;{\n]*[ui]?image[23]D)"),
                     textures = countElements(R"(uniform [ui]?sampler)"),
                     blocks = count(R"(std140\) uniform )"),
                     targets = stage == Stage::fragment ? count(R"(layout\(location = \d+\) out )") : 0;
  // A location holds up to four numbers.
  const auto handed = [&](const char* pattern) { return 4 * highest(pattern); };
  Uses uses{
      {"GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS", highest(R"(binding = (\d+), std430\))")},
      {"GL_MAX_COMBINED_SHADER_STORAGE_BLOCKS", storage},
      {"GL_MAX_IMAGE_UNITS", highest(R"(layout\(binding = (\d+)[^)]*\) uniform [^;{\n]*[ui]?image[23]D)")},
      {"GL_MAX_COMBINED_IMAGE_UNIFORMS", images},
      {"GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS", highest(R"(layout\(binding = (\d+)\) uniform [ui]?sampler)")},
      {"GL_MAX_UNIFORM_BUFFER_BINDINGS", highest(R"(binding = (\d+), std140\))")},
      {"GL_MAX_COMBINED_UNIFORM_BLOCKS", blocks},
      {"GL_MAX_COMBINED_SHADER_OUTPUT_RESOURCES", storage + images + targets}};
  switch (stage) {
    case Stage::vertex:
      uses["GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS"] = storage;
      uses["GL_MAX_VERTEX_IMAGE_UNIFORMS"] = images;
      uses["GL_MAX_VERTEX_TEXTURE_IMAGE_UNITS"] = textures;
      uses["GL_MAX_VERTEX_UNIFORM_BLOCKS"] = blocks;
      uses["GL_MAX_VARYING_VECTORS"] = highest(R"(layout\(location = (\d+)\) [^;\n]*out )");
      uses["GL_MAX_VERTEX_OUTPUT_COMPONENTS"] = handed(R"(layout\(location = (\d+)\) [^;\n]*out )");
      break;
    case Stage::geometry:
      uses["a geometry shader"] = 1;
      break;
    case Stage::fragment:
      uses["GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS"] = storage;
      uses["GL_MAX_FRAGMENT_IMAGE_UNIFORMS"] = images;
      uses["GL_MAX_TEXTURE_IMAGE_UNITS"] = textures;
      uses["GL_MAX_FRAGMENT_UNIFORM_BLOCKS"] = blocks;
      uses["GL_MAX_FRAGMENT_INPUT_COMPONENTS"] = handed(R"(layout\(location = (\d+)\) [^;\n]*in )");
      uses["GL_MAX_DRAW_BUFFERS"] = highest(R"(layout\(location = (\d+)\) out )");
      break;
    case Stage::compute: {
      uses["GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS"] = storage;
      uses["GL_MAX_COMPUTE_IMAGE_UNIFORMS"] = images;
      uses["GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS"] = textures;
      uses["GL_MAX_COMPUTE_UNIFORM_BLOCKS"] = blocks;
      uses["GL_MAX_COMPUTE_SHARED_MEMORY_SIZE"] = sharedBytesOf(code.spirv());
      std::smatch size;
      const std::regex group(R"(local_size_x = (\d+), local_size_y = (\d+), local_size_z = (\d+))");
      REQUIRE(std::regex_search(glsl, size, group));
      std::int64_t invocations = 1;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t along = std::stoll(size[axis + 1]);
        uses[fmt::format("GL_MAX_COMPUTE_WORK_GROUP_SIZE[{}]", axis)] = along;
        invocations *= along;
      }
      uses["GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS"] = invocations;
      break;
    }
  }
  return uses;
}

/// Limits on a program count what two stages use twice (OpenGL 4.5, 7.8 and 11.1.3.12); the others have
/// stages of their own, or are numbers of units that all stages share.
Uses usesOf(const shader::ShaderPack& pack, const shader::PackedVariant& variant) {
  Uses together;
  for (const shader::PackedStage& stage : variant.stages)
    for (const auto& [limit, used] : usesOf(pack.codes[stage.code], stage.stage)) {
      std::int64_t& sum = together[limit];
      const bool ofProgram =
          limit.rfind("GL_MAX_COMBINED_", 0) == 0 && limit.find("_UNITS") == std::string::npos;
      sum = ofProgram ? sum + used : std::max(sum, used);
    }
  return together;
}

std::vector<shader::ShaderPack> builtPacks() {
  std::vector<shader::ShaderPack> packs;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(test::binaryDirectory() / "lib"))
    if (entry.path().extension() == ".shaderpack") packs.push_back(shader::readShaderPack(entry.path()));
  return packs;
}

}  // namespace

TEST_CASE("no committed program uses more than a device is asked for at the start") {
  // Of what OpenGL does not promise passes that draw voxels ask DeviceInfo::vertexImages.
  constexpr std::int64_t kDrawnImages = 6;
  std::map<std::string, std::int64_t> asked;
  for (const Requirement& one : requirements()) asked[one.name] = one.least;
  std::size_t variants = 0;
  Uses most;
  for (const shader::ShaderPack& pack : builtPacks()) {
    for (const shader::PackedProgram& program : pack.programs) {
      asked["GL_MAX_VERTEX_IMAGE_UNIFORMS"] = program.name.ends_with("_drawn") ? kDrawnImages : 0;
      std::set<std::vector<std::size_t>> seen;
      for (const shader::PackedVariant& variant : program.variants) {
        std::vector<std::size_t> codes;
        for (const shader::PackedStage& stage : variant.stages) codes.push_back(stage.code);
        if (!seen.insert(codes).second) continue;
        ++variants;
        for (const auto& [limit, used] : usesOf(pack, variant)) {
          INFO(pack.technique << "/" << program.name << ": " << limit);
          REQUIRE(asked.contains(limit));
          CHECK(used <= asked[limit]);
          most[limit] = std::max(most[limit], used);
        }
      }
      for (const shader::PackedBinding& binding : program.bindings) {
        if (binding.kind != shader::BindingKind::uniform) continue;
        INFO(pack.technique << "/" << program.name << ": " << binding.name);
        const auto bytes = static_cast<std::int64_t>(binding.minimumBytes);
        CHECK(bytes <= asked["GL_MAX_UNIFORM_BLOCK_SIZE"]);
        most["GL_MAX_UNIFORM_BLOCK_SIZE"] = std::max(most["GL_MAX_UNIFORM_BLOCK_SIZE"], bytes);
      }
    }
  }
  CHECK(variants > 50);
  // The patterns find them, and nothing is asked of a device that no shader comes near to.
  for (const Requirement& one : requirements()) {
    INFO(one.name << " is asked to be " << one.least << ", and at most " << most[one.name] << " are used");
    CHECK(most[one.name] > 0);
    CHECK((one.least <= one.promised || most[one.name] > one.promised));
  }
}

TEST_CASE("every packed module is valid SPIR-V for OpenGL 4.5, with fast arithmetic too") {
  spvtools::SpirvTools tools(SPV_ENV_OPENGL_4_5);
  std::string problem;
  tools.SetMessageConsumer(
      [&](spv_message_level_t, const char*, const spv_position_t& position, const char* message) {
        problem = fmt::format("{} (word {})", message, position.index);
      });
  std::size_t modules = 0;
  for (const shader::ShaderPack& pack : builtPacks()) {
    for (const shader::PackedCode& code : pack.codes) {
      INFO(pack.technique << ", code " << &code - pack.codes.data());
      const bool valid = tools.Validate(code.spirv());
      INFO(problem);
      REQUIRE(valid);
      ++modules;
    }
    // The two differ by decorations alone, so that a sample of them says enough.
    for (std::size_t i = 0; i < pack.codes.size(); i += 16)
      REQUIRE(tools.Validate(shader::withoutContractionMarks(pack.codes[i].spirv())));
  }
  CHECK(modules > 50);
  // The validator would say so.
  std::vector<std::uint32_t> broken = builtPacks().front().codes.front().spirv();
  broken[3] = 1;  // the bound of its ids
  CHECK_FALSE(tools.Validate(broken));
}

TEST_CASE("all packs together take less than 4 MB, since the variants of a program are compressed together") {
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(test::binaryDirectory() / "lib"))
    if (entry.path().extension() == ".shaderpack") bytes += std::filesystem::file_size(entry.path());
  CHECK(bytes > 500'000);
  CHECK(bytes < 4'000'000);
}

TEST_CASE("every limit that is asked for at the start is in the documentation, with its number") {
  std::ifstream file(test::sourceDirectory() / "docs/gpu.md");
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  std::size_t rows = 0;
  for (std::size_t at = text.find("| `GL_MAX_"); at != std::string::npos;
       at = text.find("| `GL_MAX_", at + 1))
    ++rows;
  CHECK(rows == requirements().size());
  for (const Requirement& one : requirements())
    CHECK_THAT(text, Tells(fmt::format("| `{}` | {} | {} |", one.name, one.least, one.promised)));
}

TEST_CASE("a time stamp counter that begins again at 0 gives the time that has passed") {
  constexpr std::uint64_t kFull36 = std::uint64_t{1} << 36;
  CHECK(countedBetween(1000, 3500, 36) == 2500);
  CHECK(countedBetween(kFull36 - 1000, 500, 36) == 1500);
  CHECK(countedBetween(kFull36 - 1000, 500, 64) == 500 - (kFull36 - 1000));
  CHECK(countedBetween(~std::uint64_t{0} - 9, 20, 64) == 30);
  CHECK(countedBetween((std::uint64_t{1} << 30) - 1, 0, 30) == 1);  // the least that OpenGL 4.5 allows
}

TEST_CASE("what is downloaded at a time fits in the 31 bits of OpenGL's size, and the parts are the whole") {
  struct Example {
    int slices, rows;
    std::uint64_t rowBytes, most, parts;
  };
  constexpr std::uint64_t kMost = 0x7fffffff;
  const Example examples[] = {
      {1, 16384, 16384 * 16, kMost, 3},  // the largest image that OpenGL promises, four floats a texel: 4 GiB
      {1, 16384, 16384 * 8, kMost, 2},   // 2 GiB: one byte too many
      {1, 16384, 16384 * 4, kMost, 1},   // 1 GiB
      {2048, 2048, 2048 * 4, kMost, 17},  // 127 slices of 16 MiB at a time
      {6, 16384, 16384 * 16, kMost, 18},  // no slice fits
      {5, 7, 12, 100, 5},                 // one slice of 84 bytes
      {5, 7, 12, 168, 3},                 // two slices
      {5, 7, 12, 12, 35},                 // a row
  };
  for (const Example& example : examples) {
    const std::vector<Rows> parts = partsOf(example.slices, example.rows, example.rowBytes, example.most);
    INFO(example.slices << " slices of " << example.rows << " rows of " << example.rowBytes << " bytes");
    CHECK(parts.size() == example.parts);
    std::uint64_t end = 0;
    for (const Rows& part : parts) {
      CHECK(part.bytes <= example.most);
      CHECK(part.bytes == example.rowBytes * static_cast<std::uint64_t>(part.rows * part.slices));
      CHECK(part.offset == end);
      CHECK(part.offset == example.rowBytes * (static_cast<std::uint64_t>(part.firstSlice) *
                                                   static_cast<std::uint64_t>(example.rows) +
                                               static_cast<std::uint64_t>(part.firstRow)));
      CHECK(part.firstRow + part.rows <= example.rows);
      CHECK((part.slices == 1 || (part.firstRow == 0 && part.rows == example.rows)));
      end = part.offset + part.bytes;
    }
    CHECK(end == example.rowBytes * static_cast<std::uint64_t>(example.rows) *
                     static_cast<std::uint64_t>(example.slices));
  }
}
