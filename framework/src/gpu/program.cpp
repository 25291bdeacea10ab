// Programs from SPIR-V (ARB_gl_spirv) or from the GLSL text that SPIRV-Cross made of the same SPIR-V.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "gpu/state.h"
#include "lumivox/base/error.h"

namespace lumivox::gpu {
namespace {

GLenum stageOf(Stage stage) {
  switch (stage) {
    case Stage::vertex:
      return GL_VERTEX_SHADER;
    case Stage::geometry:
      return GL_GEOMETRY_SHADER;
    case Stage::fragment:
      return GL_FRAGMENT_SHADER;
    case Stage::compute:
      return GL_COMPUTE_SHADER;
  }
  return 0;
}

const char* stageName(Stage stage) {
  switch (stage) {
    case Stage::vertex:
      return "vertex";
    case Stage::geometry:
      return "geometry";
    case Stage::fragment:
      return "fragment";
    case Stage::compute:
      return "compute";
  }
  return "";
}

enum class ConstantType { boolean, signedInteger, unsignedInteger, real };

/// Specialisation constants of a module: id -> type (SPIR-V 1.0, sections 2.3 and 3.32).
std::map<std::uint32_t, ConstantType> specialisationConstants(std::span<const std::uint32_t> words) {
  constexpr std::uint32_t kOpTypeBool = 20, kOpTypeInt = 21, kOpTypeFloat = 22, kOpSpecConstantTrue = 48,
                          kOpSpecConstantFalse = 49, kOpSpecConstant = 50, kOpFunction = 54, kOpDecorate = 71,
                          kDecorationSpecId = 1;
  std::map<std::uint32_t, std::uint32_t> idOfResult;
  std::map<std::uint32_t, ConstantType> types, constants;
  for (std::size_t at = 5; at < words.size();) {
    const std::uint32_t operation = words[at] & 0xffffu, length = words[at] >> 16;
    if (length == 0 || at + length > words.size() || operation == kOpFunction) break;
    const std::uint32_t* operands = &words[at + 1];
    if (operation == kOpDecorate && length == 4 && operands[1] == kDecorationSpecId)
      idOfResult[operands[0]] = operands[2];
    if (operation == kOpTypeBool) types[operands[0]] = ConstantType::boolean;
    if (operation == kOpTypeFloat) types[operands[0]] = ConstantType::real;
    if (operation == kOpTypeInt && length == 4) {
      types[operands[0]] = operands[2] != 0 ? ConstantType::signedInteger : ConstantType::unsignedInteger;
    }
    if (operation == kOpSpecConstant || operation == kOpSpecConstantTrue ||
        operation == kOpSpecConstantFalse) {
      const auto found = idOfResult.find(operands[1]);
      if (found != idOfResult.end()) constants[found->second] = types[operands[0]];
    }
    at += length;
  }
  return constants;
}

std::string glslValue(ConstantType type, std::uint32_t bits) {
  switch (type) {
    case ConstantType::boolean:
      return bits != 0 ? "true" : "false";
    case ConstantType::unsignedInteger:
      return fmt::format("{}u", bits);
    case ConstantType::signedInteger:
      return fmt::format("int({}u)", bits);
    case ConstantType::real:
      return fmt::format("uintBitsToFloat({}u)", bits);
  }
  return {};
}

std::string infoLog(GLuint handle, bool program) {
  GLint length = 0;
  program ? glGetProgramiv(handle, GL_INFO_LOG_LENGTH, &length)
          : glGetShaderiv(handle, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
  program ? glGetProgramInfoLog(handle, length, &length, log.data())
          : glGetShaderInfoLog(handle, length, &length, log.data());
  log.resize(static_cast<std::size_t>(std::max(length, 0)));
  while (!log.empty() && (log.back() == '\n' || log.back() == '\0')) log.pop_back();
  return log.empty() ? "the driver gives no reason" : log;
}

void specialise(GLuint shader, const StageCode& code, std::span<const SpecialisationValue> constants) {
  // OpenGL allows only ids that this stage still has.
  const auto known = specialisationConstants(code.spirv);
  std::vector<GLuint> ids, values;
  for (const SpecialisationValue& constant : constants) {
    if (!known.contains(constant.id)) continue;
    ids.push_back(constant.id);
    values.push_back(constant.bits);
  }
  glShaderBinary(1, &shader, GL_SHADER_BINARY_FORMAT_SPIR_V_ARB, code.spirv.data(),
                 static_cast<GLsizei>(code.spirv.size_bytes()));
  const auto specializeShader = epoxy_gl_version() >= 46 ? glSpecializeShader : glSpecializeShaderARB;
  specializeShader(shader, "main", static_cast<GLuint>(ids.size()), ids.data(), values.data());
}

void compileText(GLuint shader, const StageCode& code, std::span<const SpecialisationValue> constants) {
  const auto known = specialisationConstants(code.spirv);
  std::string definitions;
  for (const SpecialisationValue& constant : constants) {
    const auto found = known.find(constant.id);
    if (found == known.end()) continue;
    definitions += fmt::format("#define SPIRV_CROSS_CONSTANT_ID_{} {}\n", constant.id,
                               glslValue(found->second, constant.bits));
  }
  // The version line must stay the first.
  std::string text(code.glsl);
  const std::size_t version = text.find("#version");
  const std::size_t lineEnd = version == std::string::npos ? std::string::npos : text.find('\n', version);
  text.insert(lineEnd == std::string::npos ? 0 : lineEnd + 1, definitions);
  const GLchar* source = text.c_str();
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
}

/// The name is hashed too, since messages contain it.
ContentHash contentsOf(const std::string& name, std::span<const StageCode> stages,
                       std::span<const SpecialisationValue> constants) {
  Hasher hasher;
  hasher.add(name);
  for (const StageCode& code : stages) {
    hasher.add(code.stage).add(std::uint64_t{code.spirv.size()});
    hasher.bytes(code.spirv.data(), code.spirv.size_bytes()).add(code.glsl);
  }
  for (const SpecialisationValue& constant : constants) hasher.add(constant.id).add(constant.bits);
  return hasher.finish();
}

}  // namespace

GLuint linkProgram(std::initializer_list<std::pair<GLenum, std::vector<const char*>>> stages) {
  const GLuint program = glCreateProgram();
  for (const auto& [stage, texts] : stages) {
    const GLuint shader = glCreateShader(stage);
    glShaderSource(shader, static_cast<GLsizei>(texts.size()), texts.data(), nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  return program;
}

std::optional<ProgramCache::Linked> ProgramCache::hold(const ContentHash& contents) {
  const auto found = handles_.find(contents);
  if (found == handles_.end()) return std::nullopt;
  Entry& entry = entries_.at(found->second);
  if (entry.holders++ == 0) waiting_.erase(entry.waitsSince);
  return entry.linked;
}

void ProgramCache::keep(const ContentHash& contents, const Linked& linked) {
  handles_.emplace(contents, linked.handle);
  entries_.emplace(linked.handle, Entry{contents, linked, 1, 0});
}

bool ProgramCache::release(GLuint handle) {
  constexpr std::size_t kMostWaiting = 512;  // more than all committed pipelines together need
  Entry& entry = entries_.at(handle);
  if (--entry.holders > 0) return false;
  entry.waitsSince = ++releases_;
  waiting_.emplace(entry.waitsSince, handle);
  if (waiting_.size() <= kMostWaiting) return false;
  const auto oldest = waiting_.begin();
  glDeleteProgram(oldest->second);
  handles_.erase(entries_.at(oldest->second).contents);
  entries_.erase(oldest->second);
  waiting_.erase(oldest);
  return true;
}

void ProgramCache::clear() {
  for (const auto& [handle, entry] : entries_) glDeleteProgram(handle);
  handles_.clear();
  entries_.clear();
  waiting_.clear();
}

Program::Program(Device& device, std::string name, std::span<const StageCode> stages,
                 std::span<const SpecialisationValue> constants)
    : device_(device.state()), name_(std::move(name)) {
  device_->use();
  const ContentHash contents = contentsOf(name_, stages, constants);
  if (const auto linked = device_->programs.hold(contents)) {
    handle_ = linked->handle;
    groupSize_ = linked->groupSize;
    return;
  }
  const bool spirv = device_->shaderInput == ShaderInput::spirv;
  const char* route = spirv ? "SPIR-V" : "GLSL";
  std::vector<GLuint> shaders;
  handle_ = glCreateProgram();
  const auto release = [&] {
    for (const GLuint shader : shaders) glDeleteShader(shader);
    // The driver's messages about a failed shader repeat its log.
    device_->messages.forgetErrors();
    glGetError();
  };
  const auto fail = [&](const std::string& what) {
    release();
    glDeleteProgram(handle_);
    throw Error(fmt::format("shader program {} ({}): {}", name_, route, what));
  };

  for (const StageCode& code : stages) {
    const GLuint shader = glCreateShader(stageOf(code.stage));
    shaders.push_back(shader);
    spirv ? specialise(shader, code, constants) : compileText(shader, code, constants);
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled == GL_FALSE)
      fail(fmt::format("the driver refuses the {} stage: {}", stageName(code.stage), infoLog(shader, false)));
    glAttachShader(handle_, shader);
  }
  glLinkProgram(handle_);
  GLint linked = GL_FALSE;
  glGetProgramiv(handle_, GL_LINK_STATUS, &linked);
  if (linked == GL_FALSE) fail("the driver cannot link the stages: " + infoLog(handle_, true));
  release();
  if (stages.size() == 1 && stages.front().stage == Stage::compute)
    glGetProgramiv(handle_, GL_COMPUTE_WORK_GROUP_SIZE, &groupSize_[0]);
  glObjectLabel(GL_PROGRAM, handle_, static_cast<GLsizei>(std::min<std::size_t>(name_.size(), 200)),
                name_.c_str());
  device_->programs.keep(contents, {handle_, groupSize_});
}

Program::~Program() {
  if (device_->useToRelease() && device_->programs.release(handle_)) device_->forgetBindings();
}

}  // namespace lumivox::gpu
