#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstdlib>

#include "gpu/requirements.h"
#include "gpu/state.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox::gpu {
namespace {

void onDriverMessage(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                     const GLchar* message, const void* user) {
  using Kind = DriverMessages::Kind;
  using Severity = DriverMessages::Severity;
  auto& state = *static_cast<DeviceState*>(const_cast<void*>(user));
  const Kind kind = type == GL_DEBUG_TYPE_ERROR                ? Kind::error
                    : type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR ? Kind::undefinedBehaviour
                                                               : Kind::advice;
  const Severity weight = severity == GL_DEBUG_SEVERITY_HIGH           ? Severity::high
                          : severity == GL_DEBUG_SEVERITY_NOTIFICATION ? Severity::notification
                                                                       : Severity::low;
  state.messages.hear(
      kind, weight, source, id,
      length >= 0 ? std::string(message, static_cast<std::size_t>(length)) : std::string(message),
      state.pass);
}

const char* errorName(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "GL_OUT_OF_MEMORY";
    case GL_CONTEXT_LOST:
      return "GL_CONTEXT_LOST";
    default:
      return "an unknown error";
  }
}

std::string glText(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text != nullptr ? reinterpret_cast<const char*>(text) : "";
}

}  // namespace

// ---- DeviceState
// ------------------------------------------------------------------------------------------------

namespace {

constexpr int kMostSamples = 8;  // that any shader uses

/// NVIDIA's driver (580.159) makes wrong programs of SPIR-V, and right ones of the GLSL text that is made of
/// the same SPIR-V: docs/gpu.md, "On a graphics card".
bool compilesSpirvRight(const std::string& vendor) {
  return vendor != "NVIDIA Corporation";
}

}  // namespace

DeviceState::DeviceState(const DeviceOptions& options)
    : context(options.device, options.debugContext),
      memoryBytes(options.memoryBytes),
      debug(options.debugContext),
      arithmetic(options.arithmetic) {
  info.vendor = glText(GL_VENDOR);
  info.renderer = glText(GL_RENDERER);
  info.version = glText(GL_VERSION);
  info.platform = context.platform();
  info.software = isSoftwareRenderer(info.renderer);
  info.spirv = epoxy_gl_version() >= 46 || epoxy_has_gl_extension("GL_ARB_gl_spirv");
  if (options.shaderInput == ShaderInput::spirv && !info.spirv) {
    throw AbsentError(
        fmt::format("{} does not load SPIR-V (GL_ARB_gl_spirv); use GLSL shaders instead", info.renderer));
  }
  shaderInput = options.shaderInput != ShaderInput::automatic   ? options.shaderInput
                : info.spirv && compilesSpirvRight(info.vendor) ? ShaderInput::spirv
                                                                : ShaderInput::glsl;
  requireLimits();
  if (debug) listen();
  readLimits();

  glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  glDisable(GL_DITHER);
  glDisable(GL_CULL_FACE);
  glDepthFunc(GL_LEQUAL);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glCreateVertexArrays(1, &vertexArray);
  glBindVertexArray(vertexArray);
  makeSamplers();
  uniforms.create(static_cast<std::size_t>(limits.uniformAlignment));
  glCreateQueries(GL_TIMESTAMP, 2, timestampQueries.data());
  check("setting up the device");
}

DeviceState::~DeviceState() {
  if (!useToRelease()) return;
  if (debug) glDebugMessageCallback(nullptr, nullptr);
  framebuffers.clear();
  programs.clear();
  glDeleteQueries(2, timestampQueries.data());
  uniforms.destroy();
  glDeleteSamplers(static_cast<GLsizei>(samplers.size()), samplers.data());
  glDeleteVertexArrays(1, &vertexArray);
}

void DeviceState::listen() {
  glEnable(GL_DEBUG_OUTPUT);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(onDriverMessage, this);
}

void DeviceState::requireLimits() const {
  const std::string unmet = unmetRequirements([](const Requirement& one) {
    GLint64 value = 0;
    one.index < 0 ? glGetInteger64v(one.limit, &value)
                  : glGetInteger64i_v(one.limit, static_cast<GLuint>(one.index), &value);
    return static_cast<std::int64_t>(value);
  });
  if (!unmet.empty())
    throw AbsentError(
        fmt::format("{} ({}) has less than Lumivox needs:\n{}", info.renderer, info.platform, unmet));
}

void DeviceState::readLimits() {
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limits.textureSize2d);
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &limits.textureLayers);
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limits.textureSize3d);
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limits.storageBlockBytes);
  glGetIntegerv(GL_MAX_UNIFORM_BLOCK_SIZE, &limits.uniformBlockBytes);
  glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &limits.uniformAlignment);
  for (GLuint axis = 0; axis < 3; ++axis) {
    glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, axis, &limits.groupCount[axis]);
  }
  glGetIntegerv(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, &limits.sampledUnits);
  glGetIntegerv(GL_MAX_IMAGE_UNITS, &limits.imageUnits);
  glGetIntegerv(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, &limits.storageUnits);
  glGetIntegerv(GL_MAX_UNIFORM_BUFFER_BINDINGS, &limits.uniformUnits);
  glGetIntegerv(GL_MAX_FRAMEBUFFER_SAMPLES, &info.maxSamples);
  glGetIntegerv(GL_MAX_VERTEX_IMAGE_UNIFORMS, &info.vertexImages);
  glGetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &limits.timestampBits);
  GLint strategy = GL_NO_RESET_NOTIFICATION;
  glGetIntegerv(GL_RESET_NOTIFICATION_STRATEGY, &strategy);
  tellsResets = strategy == GL_LOSE_CONTEXT_ON_RESET;
  // A card that offers 64 runs several invocations for a pixel, each with a part of the samples.
  info.maxSamples = std::clamp(info.maxSamples, 1, kMostSamples);
  info.maxTextureSize3d = limits.textureSize3d;
  info.maxStorageBytes = static_cast<std::uint64_t>(limits.storageBlockBytes);
  cache.sampled.resize(static_cast<std::size_t>(limits.sampledUnits));
  cache.images.resize(static_cast<std::size_t>(limits.imageUnits));
  cache.storage.resize(static_cast<std::size_t>(limits.storageUnits));
  cache.uniforms.resize(static_cast<std::size_t>(limits.uniformUnits));
}

void DeviceState::makeSamplers() {
  struct Settings {
    GLint minify, magnify, wrap;
    bool compare;
  };
  // In the order of Sampling.
  const std::array<Settings, 8> settings{{
      {GL_NEAREST, GL_NEAREST, GL_CLAMP_TO_EDGE, false},
      {GL_LINEAR, GL_LINEAR, GL_CLAMP_TO_EDGE, false},
      {GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR, GL_CLAMP_TO_EDGE, false},
      {GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR, GL_REPEAT, false},
      {GL_LINEAR, GL_LINEAR, GL_CLAMP_TO_BORDER, false},
      {GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR, GL_CLAMP_TO_BORDER, false},
      {GL_LINEAR, GL_LINEAR, GL_CLAMP_TO_EDGE, true},
      {GL_LINEAR_MIPMAP_NEAREST, GL_LINEAR, GL_CLAMP_TO_EDGE, false},
  }};
  glCreateSamplers(static_cast<GLsizei>(samplers.size()), samplers.data());
  for (std::size_t i = 0; i < samplers.size(); ++i) {
    glSamplerParameteri(samplers[i], GL_TEXTURE_MIN_FILTER, settings[i].minify);
    glSamplerParameteri(samplers[i], GL_TEXTURE_MAG_FILTER, settings[i].magnify);
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
      glSamplerParameteri(samplers[i], axis, settings[i].wrap);
    }
    if (settings[i].compare) {
      glSamplerParameteri(samplers[i], GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
      glSamplerParameteri(samplers[i], GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    }
  }
}

void DeviceState::requireContext(const std::string& what, bool errorTold) {
  // A driver may report a reset only while it lasts, but the context stays lost.
  const GLenum status = tellsResets || errorTold ? glGetGraphicsResetStatus() : GL_NO_ERROR;
  if (status != GL_NO_ERROR || errorTold)
    lost = lost.value_or(status == GL_GUILTY_CONTEXT_RESET     ? Reset::own
                         : status == GL_INNOCENT_CONTEXT_RESET ? Reset::others
                                                               : Reset::unknown);
  if (!lost) return;
  messages.forgetErrors();
  throw Error(what + ": " + lostContextText(*lost, pass));
}

void DeviceState::check(const std::string& what) {
  // A debug context has already reported the error, in more detail.
  GLenum error = glGetError();
  requireContext(what, error == GL_CONTEXT_LOST);
  if (error != GL_NO_ERROR && !messages.hasErrors())
    messages.addError(fmt::format("{}{}", errorName(error),
                                  debug ? "" : " (with --debug-context it names the pass and the reason)"));
  // A device keeps a flag for each kind of error.
  for (int i = 0; i < 16 && error != GL_NO_ERROR; ++i) error = glGetError();
  if (messages.hasErrors()) throw Error(messages.takeErrors(what));
}

/// Below this size, asking the system for the free memory costs more than it is worth.
constexpr std::uint64_t kNotWorthAsking = 16 << 20;

void DeviceState::requireHostMemory(std::uint64_t bytes, const std::string& label) {
  if (bytes >= kNotWorthAsking) requireMemory(bytes, "downloading " + label);
}

std::string DeviceState::besideText() const {
  return fmt::format(" beside the {} of all other textures and buffers", formatBytes(allocatedBytes));
}

void DeviceState::requireDeviceMemory(std::uint64_t bytes, const std::string& what) {
  const auto refuse = [&](std::uint64_t available, const std::string& where) {
    // After rounding, both sizes may read the same.
    const bool alike = formatBytes(bytes) == formatBytes(available);
    const auto text = [&](std::uint64_t count) {
      return alike ? fmt::format("{} B", count) : formatBytes(count);
    };
    throw Error(fmt::format("{} needs {}, but only {} {} left{}", what, text(bytes), text(available), where,
                            besideText()));
  };
  if (memoryBytes > 0 && allocatedBytes + bytes > memoryBytes)
    refuse(memoryBytes - std::min(memoryBytes, allocatedBytes),
           fmt::format("of the limit of {} are", formatBytes(memoryBytes)));
  if (bytes < kNotWorthAsking) return;
  // Memory in use is already missing from the available memory: drivers fill new resources with zeros.
  if (info.software) {
    if (const std::uint64_t available = availableMemory(); bytes > available)
      refuse(available, "of memory are");
  } else if (epoxy_has_gl_extension("GL_NVX_gpu_memory_info")) {
    GLint availableKib = 0;
    glGetIntegerv(GL_GPU_MEMORY_INFO_CURRENT_AVAILABLE_VIDMEM_NVX, &availableKib);
    const std::uint64_t available = static_cast<std::uint64_t>(availableKib) << 10;
    if (bytes > available) refuse(available, fmt::format("on {} are", info.renderer));
  }
}

void DeviceState::allocated(const void* resource, std::uint64_t bytes) {
  allocatedBytes += bytes;
  peakBytes = std::max(peakBytes, allocatedBytes);
  if (account == nullptr) return;
  charged.emplace(resource, account);
  account->add(bytes);
}

void DeviceState::freed(const void* resource, std::uint64_t bytes) {
  assert(allocatedBytes >= bytes);
  allocatedBytes -= bytes;
  const auto owner = charged.find(resource);
  if (owner == charged.end()) return;
  owner->second->remove(bytes);
  charged.erase(owner);
}

void DeviceState::forgetBindings() {
  // No object has this name, so the next bind is never mistaken for a repetition.
  constexpr GLuint kNoObject = ~GLuint{0};
  cache.program = kNoObject;
  std::fill(cache.sampled.begin(), cache.sampled.end(), BindingCache::Sampled{kNoObject, kNoObject});
  std::fill(cache.images.begin(), cache.images.end(), BindingCache::Image{kNoObject, -1});
  std::fill(cache.storage.begin(), cache.storage.end(), kNoObject);
  for (auto& uniform : cache.uniforms) uniform.bytes.clear();
  elementBuffer = kNoObject;
}

// ---- UniformBuffer
// ------------------------------------------------------------------------------------------------

void UniformBuffer::create(std::size_t alignment) {
  // A segment has room for the blocks of some thousand draws, and for many blocks of 16 KiB, the largest that
  // OpenGL promises.
  constexpr std::size_t kSegmentBytes = 1 << 20;
  ring_.emplace(*this, kSegmentBytes, std::max<std::size_t>(alignment, 16));
  glCreateBuffers(1, &buffer_);
  constexpr GLbitfield kFlags = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  constexpr std::size_t kBytes = kSegmentBytes * UniformRing::kSegments;
  glNamedBufferStorage(buffer_, kBytes, nullptr, kFlags);
  mapped_ = static_cast<std::byte*>(glMapNamedBufferRange(buffer_, 0, kBytes, kFlags));
  if (mapped_ == nullptr) throw Error("the OpenGL driver cannot map a uniform buffer");
}

void UniformBuffer::destroy() {
  for (GLsync fence : fences_) {
    if (fence != nullptr) glDeleteSync(fence);
  }
  glUnmapNamedBuffer(buffer_);
  glDeleteBuffers(1, &buffer_);
}

GLintptr UniformBuffer::write(std::span<const std::byte> block) {
  const std::size_t offset = ring_->place(block.size());
  std::memcpy(mapped_ + offset, block.data(), block.size());
  return static_cast<GLintptr>(offset);
}

void UniformBuffer::insert(std::size_t segment) {
  fences_[segment] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}

void UniformBuffer::wait(std::size_t segment) {
  if (fences_[segment] == nullptr) return;
  glClientWaitSync(fences_[segment], GL_SYNC_FLUSH_COMMANDS_BIT, GL_TIMEOUT_IGNORED);
  glDeleteSync(fences_[segment]);
  fences_[segment] = nullptr;
}

// ---- Device
// -------------------------------------------------------------------------------------------------------

Device::Device(const DeviceOptions& options) : state_(std::make_shared<DeviceState>(options)) {}
Device::~Device() = default;

const DeviceInfo& Device::info() const {
  state_->checkTimers();
  return state_->info;
}

ShaderInput Device::shaderInput() const {
  return state_->shaderInput;
}

Arithmetic Device::arithmetic() const {
  return state_->arithmetic;
}

std::string Device::programRoute() const {
  return std::string(state_->shaderInput == ShaderInput::spirv ? "spirv" : "glsl") +
         (state_->arithmetic == Arithmetic::fast ? " fast" : "");
}

std::string programRouteText(const Device& device) {
  return std::string(device.shaderInput() == ShaderInput::spirv ? "SPIR-V" : "GLSL made from the SPIR-V") +
         (device.arithmetic() == Arithmetic::fast ? ", fast arithmetic" : "");
}

bool DeviceOptions::debugContextAsked() {
  const char* asked = std::getenv("LUMIVOX_DEBUG_CONTEXT");
  return asked != nullptr && *asked != '\0' && std::string_view(asked) != "0";
}

void Device::enterPass(const std::string& name) {
  state_->use();
  state_->pass = name;
}

void Device::leavePass() {
  state_->use();
  // Leaves the pass even if the check throws.
  struct Leave {
    DeviceState& state;
    ~Leave() { state.pass.clear(); }
  } leave{*state_};
  if (state_->debug) state_->check("running");
}

void DeviceState::downloaded(std::uint64_t bytes) {
  transfers.downloaded += bytes;
  if (underWay) ++transfers.stalls;
}

Device::Transfers Device::transfers() const {
  return state_->transfers;
}
std::uint64_t Device::allocatedBytes() const {
  return state_->allocatedBytes;
}
std::uint64_t Device::peakBytes() const {
  return state_->peakBytes;
}
void Device::resetPeak() {
  state_->peakBytes = state_->allocatedBytes;
}

}  // namespace lumivox::gpu
