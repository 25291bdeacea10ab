#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "gpu/state.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"

namespace lumivox::gpu {
namespace {

// The state whose context is current on this thread.
thread_local DeviceState* currentState = nullptr;

constexpr std::size_t kKeptDriverErrors = 8;

void onDriverMessage(GLenum, GLenum type, GLuint, GLenum severity, GLsizei length, const GLchar* message,
                     const void* user) {
  auto& state = *static_cast<DeviceState*>(const_cast<void*>(user));
  std::string text =
      length >= 0 ? std::string(message, static_cast<std::size_t>(length)) : std::string(message);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  if (type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR) {
    // Exceptions may not pass through the driver: DeviceState::check throws.
    if (state.driverErrors.size() < kKeptDriverErrors) state.driverErrors.push_back(std::move(text));
  } else if (severity == GL_DEBUG_SEVERITY_HIGH) {
    logWarning("the OpenGL driver says{}: {}", state.pass.empty() ? "" : " in pass " + state.pass, text);
  } else if (severity != GL_DEBUG_SEVERITY_NOTIFICATION) {
    logDetails("the OpenGL driver says{}: {}", state.pass.empty() ? "" : " in pass " + state.pass, text);
  }
}

std::string glText(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text != nullptr ? reinterpret_cast<const char*>(text) : "";
}

}  // namespace

// ---- DeviceState
// ------------------------------------------------------------------------------------------------

DeviceState::DeviceState(const DeviceOptions& options)
    : context(options.device), memoryBytes(options.memoryBytes) {
  currentState = this;
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
  shaderInput = options.shaderInput != ShaderInput::automatic ? options.shaderInput
                : info.spirv                                  ? ShaderInput::spirv
                                                              : ShaderInput::glsl;
  glEnable(GL_DEBUG_OUTPUT);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(onDriverMessage, this);
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
  use();
  glDebugMessageCallback(nullptr, nullptr);
  glDeleteQueries(2, timestampQueries.data());
  uniforms.destroy();
  glDeleteSamplers(static_cast<GLsizei>(samplers.size()), samplers.data());
  glDeleteVertexArrays(1, &vertexArray);
  currentState = nullptr;
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
  info.maxSamples = std::max(info.maxSamples, 1);
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
  const std::array<Settings, 7> settings{{
      {GL_NEAREST, GL_NEAREST, GL_CLAMP_TO_EDGE, false},
      {GL_LINEAR, GL_LINEAR, GL_CLAMP_TO_EDGE, false},
      {GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR, GL_CLAMP_TO_EDGE, false},
      {GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR, GL_REPEAT, false},
      {GL_LINEAR, GL_LINEAR, GL_CLAMP_TO_BORDER, false},
      {GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR, GL_CLAMP_TO_BORDER, false},
      {GL_LINEAR, GL_LINEAR, GL_CLAMP_TO_EDGE, true},
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

void DeviceState::use() {
  if (currentState == this) return;
  context.makeCurrent();
  currentState = this;
}

void DeviceState::check(const std::string& what) {
  if (driverErrors.empty()) return;
  std::string text = what;
  text += driverErrors.size() == 1 ? ": the OpenGL driver reports: " : ": the OpenGL driver reports:\n  ";
  text += fmt::format("{}", fmt::join(driverErrors, "\n  "));
  driverErrors.clear();
  while (glGetError() != GL_NO_ERROR) {
  }
  throw Error(text);
}

/// Below this, asking the system for what is left costs more than it tells.
constexpr std::uint64_t kNotWorthAsking = 16 << 20;

void DeviceState::requireHostMemory(std::uint64_t bytes, const std::string& label) {
  if (bytes >= kNotWorthAsking) requireMemory(bytes, "downloading " + label);
}

std::string DeviceState::besideText() const {
  return fmt::format(" beside the {} of all other textures and buffers", formatBytes(allocatedBytes));
}

void DeviceState::requireDeviceMemory(std::uint64_t bytes, const std::string& what) {
  const auto refuse = [&](std::uint64_t available, const std::string& where) {
    // Rounded, the two may read the same.
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
  // What is held already is missing from what is available: drivers fill new resources with zeros.
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

void DeviceState::allocated(std::uint64_t bytes) {
  allocatedBytes += bytes;
  peakBytes = std::max(peakBytes, allocatedBytes);
}

void DeviceState::freed(std::uint64_t bytes) {
  assert(allocatedBytes >= bytes);
  allocatedBytes -= bytes;
}

void DeviceState::forgetBindings() {
  // No object has this name, so that the next bind is never taken for a repetition.
  constexpr GLuint kNothing = ~GLuint{0};
  cache.program = kNothing;
  std::fill(cache.sampled.begin(), cache.sampled.end(), BindingCache::Sampled{kNothing, kNothing});
  std::fill(cache.images.begin(), cache.images.end(), BindingCache::Image{kNothing, -1});
  std::fill(cache.storage.begin(), cache.storage.end(), kNothing);
  for (auto& uniform : cache.uniforms) uniform.bytes.clear();
  elementBuffer = kNothing;
}

// ---- UniformRing
// --------------------------------------------------------------------------------------------------

void UniformRing::create(std::size_t alignment) {
  alignment_ = std::max<std::size_t>(alignment, 16);
  glCreateBuffers(1, &buffer_);
  constexpr GLbitfield kFlags = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  glNamedBufferStorage(buffer_, kSegmentBytes * kSegments, nullptr, kFlags);
  mapped_ = static_cast<std::byte*>(glMapNamedBufferRange(buffer_, 0, kSegmentBytes * kSegments, kFlags));
  if (mapped_ == nullptr) throw Error("the OpenGL driver cannot map a uniform buffer");
}

void UniformRing::destroy() {
  for (GLsync fence : fences_) {
    if (fence != nullptr) glDeleteSync(fence);
  }
  glUnmapNamedBuffer(buffer_);
  glDeleteBuffers(1, &buffer_);
}

GLintptr UniformRing::write(std::span<const std::byte> block) {
  assert(block.size() <= kSegmentBytes);
  std::size_t offset = (head_ + alignment_ - 1) / alignment_ * alignment_;
  const std::size_t segment = segmentSerial_ % kSegments;
  if (offset + block.size() > (segment + 1) * kSegmentBytes) {
    fences_[segment] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    ++segmentSerial_;
    const std::size_t next = segmentSerial_ % kSegments;
    if (fences_[next] != nullptr) {
      glClientWaitSync(fences_[next], GL_SYNC_FLUSH_COMMANDS_BIT, GL_TIMEOUT_IGNORED);
      glDeleteSync(fences_[next]);
      fences_[next] = nullptr;
    }
    offset = next * kSegmentBytes;
  }
  std::memcpy(mapped_ + offset, block.data(), block.size());
  head_ = offset + block.size();
  return static_cast<GLintptr>(offset);
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

void Device::enterPass(const std::string& name) {
  state_->use();
  state_->pass = name;
}

void Device::leavePass() {
  state_->use();
  const GLenum error = glGetError();
  if (error != GL_NO_ERROR && state_->driverErrors.empty()) {
    state_->driverErrors.push_back(fmt::format("OpenGL error 0x{:04x}", error));
  }
  // Also when the check throws, what follows is no longer this pass.
  struct Leave {
    DeviceState& state;
    ~Leave() { state.pass.clear(); }
  } leave{*state_};
  state_->check("running");
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
