#include "stage.h"

#include <fmt/format.h>
#include <glslang/MachineIndependent/localintermediate.h>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <glslang/SPIRV/SPVRemapper.h>

#include <charconv>
#include <fstream>
#include <mutex>
#include <spirv-tools/libspirv.hpp>
#include <spirv-tools/optimizer.hpp>
#include <sstream>
#include <vector>

#include "lumivox/base/error.h"
#include "shader/bytes.h"

namespace lumivox::shaderpack {
namespace {

// Raise it whenever this program compiles the same source to something different.
constexpr int kArtifactVersion = 9;

// `#line N "file"` directives need this extension.
constexpr const char* kPreamble =
    "#version 450 core\n#extension GL_GOOGLE_cpp_style_line_directive : require\n";

EShLanguage languageOf(gpu::Stage stage) {
  switch (stage) {
    case gpu::Stage::vertex:
      return EShLangVertex;
    case gpu::Stage::geometry:
      return EShLangGeometry;
    case gpu::Stage::fragment:
      return EShLangFragment;
    case gpu::Stage::compute:
      return EShLangCompute;
  }
  return EShLangCompute;
}

/// A line of a file, without its end; empty where there is none.
std::string lineOf(const std::string& file, int number) {
  std::ifstream lines(file);
  std::string line;
  for (int i = 0; i < number; ++i)
    if (!std::getline(lines, line)) return {};
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return line;
}

/// One line of glslang's log.
struct LogLine {
  bool isWarning = false;
  SourcePlace place;
  std::string what;
};

LogLine readLogLine(std::string line, const StageSource& source) {
  LogLine result;
  result.isWarning = line.rfind("WARNING: ", 0) == 0;
  if (result.isWarning || line.rfind("ERROR: ", 0) == 0) line.erase(0, line.find(' ') + 1);
  // The place ends at the second colon; a message without a place is about the whole entry file.
  const std::size_t colon = line.find(": ");
  const std::size_t number = colon == std::string::npos ? colon : line.rfind(':', colon - 1);
  int count = 0;
  const bool placed =
      number != std::string::npos && number + 1 < colon &&
      std::from_chars(line.data() + number + 1, line.data() + colon, count).ptr == line.data() + colon;
  result.place = placed ? SourcePlace{line.substr(0, number), count, 0}
                        : SourcePlace{source.source->entry.string(), 0, 0};
  result.what = placed ? line.substr(colon + 2) : line;
  return result;
}

/// glslang's "ERROR: file:line: what" in the form that editors follow: "file:line: error: what". The last
/// error of a source line is followed by that line. Warnings are not, since their text is part of the
/// artifact.
std::string readableLog(const std::string& log, const StageSource& source, bool warnings) {
  std::vector<LogLine> found;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line.find("compilation errors.  No code generated") != std::string::npos) continue;
    if (LogLine read = readLogLine(line, source); read.isWarning == warnings)
      found.push_back(std::move(read));
  }
  std::string text;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const SourcePlace& place = found[i].place;
    if (i > 0) text += '\n';
    text += fmt::format("{}: {}: {}", place.text(), warnings ? "warning" : "error", found[i].what);
    const bool isLast = i + 1 == found.size() || found[i + 1].place.text() != place.text();
    if (warnings || !isLast) continue;
    const std::string line = lineOf(place.file, place.line);
    if (line.find_first_not_of(" \t") != std::string::npos) text += "\n  " + line;
  }
  return text;
}

[[noreturn]] void failStage(const StageSource& source, const std::string& what) {
  throw Error(fmt::format("{}: error: {}", source.source->entry.string(), what));
}

/// Every block and sampler must state its binding. glslang gives binding 0 to one that does not, where it may
/// collide with another, and SPIR-V cannot show that the binding was missing.
void requireBindings(const glslang::TIntermediate& tree, const StageSource& source) {
  const auto* root = tree.getTreeRoot()->getAsAggregate();
  if (root == nullptr || root->getSequence().empty()) return;
  const auto* globals = root->getSequence().back()->getAsAggregate();
  if (globals == nullptr || globals->getOp() != glslang::EOpLinkerObjects) return;
  for (TIntermNode* node : globals->getSequence()) {
    const glslang::TIntermSymbol* symbol = node->getAsSymbolNode();
    if (symbol == nullptr) continue;
    const glslang::TType& type = symbol->getType();
    const bool isBlock = type.getBasicType() == glslang::EbtBlock && type.getQualifier().isUniformOrBuffer();
    if ((!isBlock && type.getBasicType() != glslang::EbtSampler) || type.getQualifier().hasBinding())
      continue;
    const std::string name(isBlock ? type.getTypeName().c_str() : symbol->getName().c_str());
    throw Error(
        fmt::format("{}: error: '{}' has no layout(binding = n)", source.source->placeOf(name).text(), name));
  }
}

std::vector<std::uint32_t> toSpirv(const StageSource& source, std::string& warnings) {
  const EShLanguage language = languageOf(source.stage);
  const std::string text = kPreamble + source.definitions + source.source->text;
  const char* string = text.c_str();
  const int length = static_cast<int>(text.size());
  const std::string name = source.source->entry.string();
  const char* names[] = {name.c_str()};
  glslang::TShader shader(language);
  shader.setStringsWithLengthsAndNames(&string, &length, names, 1);
  constexpr int kDialect = 100;  // the version of the OpenGL dialect of GLSL for SPIR-V (ARB_gl_spirv)
  shader.setEnvInput(glslang::EShSourceGlsl, language, glslang::EShClientOpenGL, kDialect);
  shader.setEnvClient(glslang::EShClientOpenGL, glslang::EShTargetOpenGL_450);
  shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_0);
  constexpr auto kMessages = static_cast<EShMessages>(EShMsgDefault | EShMsgSpvRules);
  if (!shader.parse(GetDefaultResources(), 450, ECoreProfile, false, false, kMessages)) {
    throw Error(readableLog(shader.getInfoLog(), source, false));
  }
  warnings = readableLog(shader.getInfoLog(), source, true);
  glslang::TProgram program;
  program.addShader(&shader);
  if (!program.link(kMessages)) throw Error(readableLog(program.getInfoLog(), source, false));
  requireBindings(*program.getIntermediate(language), source);
  std::vector<std::uint32_t> words;
  spv::SpvBuildLogger logger;
  glslang::SpvOptions options;
  options.disableOptimizer = true;
  glslang::GlslangToSpv(*program.getIntermediate(language), words, &logger, &options);
  if (const std::string log = logger.getAllMessages(); !log.empty()) failStage(source, log);
  return words;
}

std::string toolMessage(const char* message, const spv_position_t& position) {
  return fmt::format("{} (SPIR-V word {})", message, position.index);
}

std::vector<std::uint32_t> optimise(const std::vector<std::uint32_t>& words, const StageSource& source) {
  std::string problems;
  spvtools::Optimizer optimizer(SPV_ENV_OPENGL_4_5);
  optimizer.SetMessageConsumer(
      [&](spv_message_level_t level, const char*, const spv_position_t& position, const char* message) {
        if (level <= SPV_MSG_ERROR) problems += "\n  " + toolMessage(message, position);
      });
  optimizer.RegisterPerformancePasses();
  spvtools::OptimizerOptions options;
  options.set_run_validator(false);  // validated below, after optimisation
  std::vector<std::uint32_t> optimised;
  if (!optimizer.Run(words.data(), words.size(), &optimised, options))
    failStage(source, "the SPIR-V optimiser failed:" + problems);
  return optimised;
}

/// Numbers ids by what they name, so that the same code of two variants has the same words: the variants of a
/// pack take a quarter of the room that they take with ids in the order of their first use.
std::vector<std::uint32_t> withLikeIds(std::vector<std::uint32_t> words) {
  // The first call fills tables that all share; it takes milliseconds, where optimising takes most of a
  // second.
  static std::mutex one;
  const std::lock_guard lock(one);
  spv::spirvbin_t().remap(words, spv::spirvbin_t::MAP_ALL);
  return words;
}

void validate(const std::vector<std::uint32_t>& words, const StageSource& source) {
  std::string problems;
  spvtools::SpirvTools tools(SPV_ENV_OPENGL_4_5);
  tools.SetMessageConsumer(
      [&](spv_message_level_t level, const char*, const spv_position_t& position, const char* message) {
        if (level <= SPV_MSG_ERROR) problems += "\n  " + toolMessage(message, position);
      });
  if (!tools.Validate(words)) failStage(source, "the SPIR-V is not valid for OpenGL 4.5:" + problems);
}

}  // namespace

ContentHash StageSource::key() const {
  const glslang::Version version = glslang::GetVersion();
  Hasher hasher;
  hasher.add(kArtifactVersion).add(version.major).add(version.minor).add(version.patch);
  hasher.add(std::string_view(spvSoftwareVersionString())).add(std::string_view(kPreamble));
  hasher.add(stage).add(definitions).add(source->text).add(source->entry.string());
  return hasher.finish();
}

void startCompiler() {
  glslang::InitializeProcess();
  spv::spirvbin_t::registerErrorHandler(
      [](const std::string& problem) { throw Error("ids of SPIR-V cannot be numbered: " + problem); });
}

Artifact compileStage(const StageSource& source) {
  Artifact artifact;
  const std::vector<std::uint32_t> declared = toSpirv(source, artifact.warnings);
  requireDerivativesBeforeDiscard(declared, source);
  artifact.spirv = withLikeIds(optimise(lowerToPlainArithmetic(declared), source));
  validate(artifact.spirv, source);
  requireDerivativesBeforeDiscard(artifact.spirv, source);  // the optimiser moves code
  reflect(declared, artifact.spirv, source, artifact);
  return artifact;
}

// ---- cache
// --------------------------------------------------------------------------------------------------------

namespace {

template <class Archive, class SomeArtifact>
void exchange(Archive& archive, SomeArtifact& a) {
  archive.value(a.spirv);
  archive.each(a.bindings, [&](auto& b) {
    archive.value(b.name);
    archive.value(b.kind);
    archive.value(b.binding);
    archive.value(b.type);
    archive.value(b.textureKind);
    archive.value(b.shadow);
    archive.value(b.minimumBytes);
  });
  archive.value(a.layouts);
  archive.value(a.elementBytes);
  archive.value(a.used);
  archive.each(a.structs, [&](auto& s) {
    archive.value(s.name);
    archive.value(s.size);
    archive.each(s.members, [&](auto& m) {
      archive.value(m.name);
      archive.value(m.type);
      archive.value(m.offset);
      archive.value(m.alignment);
      archive.value(m.arrayLength);
    });
  });
  archive.each(a.constants, [&](auto& c) {
    archive.value(c.name);
    archive.value(c.id);
    archive.value(c.type);
    archive.value(c.defaultBits);
  });
  for (auto* variables : {&a.inputs, &a.outputs}) {
    archive.each(*variables, [&](auto& v) {
      archive.value(v.location);
      archive.value(v.type);
      archive.value(v.name);
    });
  }
  archive.value(a.groupSize);
  archive.value(a.warnings);
}

}  // namespace

std::string serialise(const Artifact& artifact) {
  shader::ByteWriter content;
  exchange(content, artifact);
  for (const auto& binding : artifact.bindings)
    content.value(binding.format ? static_cast<int>(*binding.format) : -1);
  const ContentHash hash = hashOf(content.bytes());
  shader::ByteWriter whole;
  whole.value(hash.high);
  whole.value(hash.low);
  whole.value(content.bytes());
  return whole.bytes();
}

std::optional<Artifact> deserialise(std::string_view bytes) {
  try {
    ContentHash hash;
    std::string content;
    shader::ByteReader whole(bytes);
    whole.value(hash.high);
    whole.value(hash.low);
    whole.value(content);
    if (!whole.atEnd() || hashOf(content) != hash) return std::nullopt;
    Artifact artifact;
    shader::ByteReader reader(content);
    exchange(reader, artifact);
    for (auto& binding : artifact.bindings) {
      int format = -1;
      reader.value(format);
      if (format >= 0) binding.format = static_cast<gpu::Format>(format);
    }
    return artifact;
  } catch (const shader::Truncated&) {
    return std::nullopt;
  }
}

}  // namespace lumivox::shaderpack
