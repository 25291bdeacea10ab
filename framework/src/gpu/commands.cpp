// Dispatches and draws: what is bound, what is drawn to.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <utility>

#include "gpu/state.h"
#include "lumivox/base/error.h"

namespace lumivox::gpu {
namespace {

struct Binder {
  DeviceState& state;
  const Program& program;
  const ResourceBinding& slot;

  void checkUnit(std::size_t count, const char* what) const {
    if (slot.binding >= count) {
      throw Error(fmt::format("{}: '{}' is at {} {}, but {} has only {}", program.name(), slot.name, what,
                              slot.binding, state.info.renderer, count));
    }
  }

  void operator()(const ResourceBinding::Sampled& sampled) const {
    assert(sampled.texture != nullptr);
    checkUnit(state.cache.sampled.size(), "texture unit");
    auto& bound = state.cache.sampled[slot.binding];
    if (bound.texture != sampled.texture->handle()) {
      bound.texture = sampled.texture->handle();
      glBindTextureUnit(slot.binding, bound.texture);
    }
    const GLuint sampler = state.samplers[static_cast<std::size_t>(sampled.sampling)];
    if (bound.sampler != sampler) {
      bound.sampler = sampler;
      glBindSampler(slot.binding, sampler);
    }
  }

  void operator()(const ResourceBinding::StorageImage& image) const {
    assert(image.texture != nullptr);
    checkUnit(state.cache.images.size(), "image unit");
    auto& bound = state.cache.images[slot.binding];
    if (bound.texture == image.texture->handle() && bound.level == image.level) return;
    const TextureDescription& description = image.texture->description();
    assert(image.level >= 0 && image.level < description.levels);
    if (traitsOf(description.format).depth) {
      throw Error(fmt::format("{}: '{}': a depth texture ('{}') cannot be a storage image", program.name(),
                              slot.name, image.texture->label()));
    }
    bound = {image.texture->handle(), image.level};
    // Volumes and arrays are bound whole: shaders address all slices.
    const GLboolean layered = description.kind == TextureKind::d2 ? GL_FALSE : GL_TRUE;
    glBindImageTexture(slot.binding, bound.texture, bound.level, layered, 0, GL_READ_WRITE,
                       traitsOf(description.format).internal);
  }

  void operator()(const ResourceBinding::Storage& storage) const {
    assert(storage.buffer != nullptr);
    checkUnit(state.cache.storage.size(), "storage buffer");
    GLuint& bound = state.cache.storage[slot.binding];
    if (bound == storage.buffer->handle()) return;
    bound = storage.buffer->handle();
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, slot.binding, bound);
  }

  void operator()(const ResourceBinding::Uniform& uniform) const {
    assert(uniform.bytes.size() > 0);
    checkUnit(state.cache.uniforms.size(), "uniform block");
    if (uniform.bytes.size() > static_cast<std::size_t>(state.limits.uniformBlockBytes)) {
      throw Error(fmt::format("{}: uniform block '{}' has {} bytes, but {} allows {}", program.name(),
                              slot.name, uniform.bytes.size(), state.info.renderer,
                              state.limits.uniformBlockBytes));
    }
    auto& bound = state.cache.uniforms[slot.binding];
    const std::span<const std::byte> bytes = uniform.bytes.bytes();
    if (bound.segmentSerial == state.uniforms.ring().segmentSerial() &&
        std::equal(bytes.begin(), bytes.end(), bound.bytes.begin(), bound.bytes.end()))
      return;
    const GLintptr offset = state.uniforms.write(bytes);
    bound.bytes.assign(bytes.begin(), bytes.end());
    bound.segmentSerial = state.uniforms.ring().segmentSerial();
    // Drivers round the size of a block up to whole vec4s; the ring has room for that.
    const std::size_t whole = (bytes.size() + 15) / 16 * 16;
    glBindBufferRange(GL_UNIFORM_BUFFER, slot.binding, state.uniforms.handle(), offset,
                      static_cast<GLsizeiptr>(whole));
  }
};

const char* framebufferProblem(GLenum status) {
  switch (status) {
    case GL_FRAMEBUFFER_INCOMPLETE_ATTACHMENT:
      return "a target cannot be drawn to";
    case GL_FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT:
      return "no target and no size";
    case GL_FRAMEBUFFER_INCOMPLETE_LAYER_TARGETS:
      return "targets with all layers and with one layer are mixed";
    case GL_FRAMEBUFFER_UNSUPPORTED:
      return "the driver does not support this combination of formats";
    default:
      return "incomplete";
  }
}

void attach(GLuint framebuffer, GLenum point, const Texture& texture, int layer) {
  const bool hasLayers = texture.description().kind != TextureKind::d2;
  if (hasLayers && layer >= 0) {
    glNamedFramebufferTextureLayer(framebuffer, point, texture.handle(), 0, layer);
  } else {
    glNamedFramebufferTexture(framebuffer, point, texture.handle(), 0);
  }
}

[[noreturn]] void refuseSamples(const DeviceState& state, int samples) {
  throw Error(fmt::format("{} samples per pixel requested, but {} has 1 to {}", samples, state.info.renderer,
                          state.info.maxSamples));
}

void setRasterState(const RasterState& state, float depthBiasScale) {
  const auto enable = [](GLenum what, bool on) { on ? glEnable(what) : glDisable(what); };
  // OpenGL writes depth only while the test is on; the function GL_ALWAYS writes without testing.
  enable(GL_DEPTH_TEST, state.depthTest || state.depthWrite);
  glDepthFunc(state.depthTest ? GL_LEQUAL : GL_ALWAYS);
  glDepthMask(state.depthWrite ? GL_TRUE : GL_FALSE);
  enable(GL_DEPTH_CLAMP, state.depthClamp);
  enable(GL_POLYGON_OFFSET_FILL, state.depthBiasSlope != 0.0f || state.depthBiasConstant != 0.0f);
  glPolygonOffset(state.depthBiasSlope, state.depthBiasConstant * depthBiasScale);
}

void clearTargets(GLuint framebuffer, const RenderTargets& targets) {
  for (std::size_t i = 0; i < targets.colours.size(); ++i) {
    const GLint buffer = static_cast<GLint>(i);
    if (targets.colours[i].texture == nullptr) continue;
    if (traitsOf(targets.colours[i].texture->description().format).integer) {
      constexpr std::array<GLuint, 4> kZero{};
      glClearNamedFramebufferuiv(framebuffer, GL_COLOR, buffer, kZero.data());
    } else {
      constexpr std::array<GLfloat, 4> kZero{};
      glClearNamedFramebufferfv(framebuffer, GL_COLOR, buffer, kZero.data());
    }
  }
  if (targets.depth != nullptr) {
    constexpr GLfloat kFar = 1.0f;
    glDepthMask(GL_TRUE);
    glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &kFar);
  }
}

std::uint64_t clearedBytes(const RenderTargets& targets) {
  std::uint64_t bytes = 0;
  const auto count = [&](const Texture* texture, int layer) {
    if (texture == nullptr) return;
    const TextureDescription& d = texture->description();
    bytes += bytesPerTexel(d.format) * static_cast<std::uint64_t>(d.width) *
             static_cast<std::uint64_t>(d.height) * static_cast<std::uint64_t>(layer >= 0 ? 1 : d.depth);
  };
  for (const ColourTarget& colour : targets.colours) count(colour.texture, colour.layer);
  count(targets.depth, targets.depthLayer);
  return bytes;
}

/// The common size of all targets, or the given one where there are none.
glm::ivec2 sizeOf(const RenderTargets& targets) {
  if (targets.colours.empty() && targets.depth == nullptr) return {targets.width, targets.height};
  glm::ivec2 size(0);
  const auto narrow = [&](const Texture* texture) {
    if (texture == nullptr) return;
    const glm::ivec2 own(texture->description().width, texture->description().height);
    size = size == glm::ivec2(0) ? own : glm::min(size, own);
  };
  for (const ColourTarget& colour : targets.colours) narrow(colour.texture);
  narrow(targets.depth);
  return size;
}

void keyOf(const RenderTargets& targets, glm::ivec2 size, FramebufferKey& key) {
  key.clear();
  const auto add = [&](const Texture* texture, int layer) {
    key.push_back(texture == nullptr ? 0 : texture->handle());
    key.push_back(layer);
  };
  for (const ColourTarget& colour : targets.colours) add(colour.texture, colour.layer);
  add(targets.depth, targets.depthLayer);
  if (targets.colours.empty() && targets.depth == nullptr)
    key.insert(key.end(), {size.x, size.y, targets.samples});
}

GLuint makeFramebuffer(DeviceState& state, const RenderTargets& targets, glm::ivec2 size) {
  GLuint framebuffer = 0;
  glCreateFramebuffers(1, &framebuffer);
  std::vector<GLenum> drawBuffers;
  for (const ColourTarget& colour : targets.colours) {
    if (colour.texture == nullptr) {
      drawBuffers.push_back(GL_NONE);
      continue;
    }
    const GLenum point = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(drawBuffers.size());
    attach(framebuffer, point, *colour.texture, colour.layer);
    drawBuffers.push_back(point);
  }
  if (targets.depth != nullptr) attach(framebuffer, GL_DEPTH_ATTACHMENT, *targets.depth, targets.depthLayer);
  if (drawBuffers.empty()) {
    glNamedFramebufferDrawBuffer(framebuffer, GL_NONE);
  } else {
    glNamedFramebufferDrawBuffers(framebuffer, static_cast<GLsizei>(drawBuffers.size()), drawBuffers.data());
  }
  if (drawBuffers.empty() && targets.depth == nullptr) {
    glNamedFramebufferParameteri(framebuffer, GL_FRAMEBUFFER_DEFAULT_WIDTH, size.x);
    glNamedFramebufferParameteri(framebuffer, GL_FRAMEBUFFER_DEFAULT_HEIGHT, size.y);
    if (targets.samples > 1) {
      glNamedFramebufferParameteri(framebuffer, GL_FRAMEBUFFER_DEFAULT_SAMPLES, targets.samples);
      glNamedFramebufferParameteri(framebuffer, GL_FRAMEBUFFER_DEFAULT_FIXED_SAMPLE_LOCATIONS, GL_TRUE);
    }
  }
  const GLenum status = glCheckNamedFramebufferStatus(framebuffer, GL_DRAW_FRAMEBUFFER);
  try {
    state.check("choosing the render targets");
    if (status != GL_FRAMEBUFFER_COMPLETE)
      throw Error(fmt::format("cannot draw to these targets: {}", framebufferProblem(status)));
    // A device may take more samples than requested, at other positions (OpenGL 4.5, 9.2.1). Mesa reports 0,
    // which says nothing.
    if (targets.samples > 1) {
      GLint samples = 0;
      glGetNamedFramebufferParameteriv(framebuffer, GL_SAMPLES, &samples);
      if (samples != 0 && samples != targets.samples)
        throw Error(fmt::format("{} samples per pixel requested, but {} would take {}", targets.samples,
                                state.info.renderer, samples));
    }
  } catch (...) {
    glDeleteFramebuffers(1, &framebuffer);
    throw;
  }
  return framebuffer;
}

}  // namespace

std::optional<GLuint> FramebufferCache::find(const FramebufferKey& key) const {
  const auto found = framebuffers_.find(key);
  return found == framebuffers_.end() ? std::nullopt : std::optional(found->second);
}

void FramebufferCache::keep(const FramebufferKey& key, GLuint framebuffer) {
  constexpr std::size_t kMost = 4096;  // several for each layer of the largest arrays
  if (framebuffers_.size() >= kMost) clear();
  framebuffers_.emplace(key, framebuffer);
}

void FramebufferCache::forget(GLuint texture) {
  std::erase_if(framebuffers_, [texture](const auto& one) {
    const auto& [key, framebuffer] = one;
    // Handles are at even indices. A framebuffer without targets has its size behind them: a false match only
    // makes it again.
    bool uses = false;
    for (std::size_t i = 0; i < key.size(); i += 2) uses = uses || key[i] == std::int64_t{texture};
    if (uses) glDeleteFramebuffers(1, &framebuffer);
    return uses;
  });
}

void FramebufferCache::clear() {
  for (const auto& [key, framebuffer] : framebuffers_) glDeleteFramebuffers(1, &framebuffer);
  framebuffers_.clear();
}

void DeviceState::bind(const Program& program, std::span<const ResourceBinding> bindings) {
  if (cache.program != program.handle()) {
    cache.program = program.handle();
    glUseProgram(cache.program);
  }
  // Room for all blocks is reserved first: blocks that are already bound must not lie in a segment that the
  // ring then leaves.
  std::size_t room = 0;
  for (const ResourceBinding& binding : bindings) {
    if (const auto* uniform = std::get_if<ResourceBinding::Uniform>(&binding.resource))
      room += uniforms.ring().roomFor(uniform->bytes.size());
  }
  if (room > uniforms.ring().segmentBytes())
    throw Error(fmt::format("{}: its uniform blocks have {} bytes together, but a command has room for {}",
                            program.name(), room, uniforms.ring().segmentBytes()));
  uniforms.ring().reserve(room);
  for (const ResourceBinding& binding : bindings)
    std::visit(Binder{*this, program, binding}, binding.resource);
  underWay = unordered = true;
}

void DeviceState::order() {
  if (std::exchange(unordered, false)) glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

void Device::dispatch(const Program& program, std::span<const ResourceBinding> bindings, glm::uvec3 groups) {
  DeviceState& state = *state_;
  state.use();
  for (int axis = 0; axis < 3; ++axis) {
    const auto limit = static_cast<std::uint32_t>(state.limits.groupCount[static_cast<std::size_t>(axis)]);
    if (groups[axis] > limit) {
      throw Error(fmt::format("{}: {} work groups along {}, but {} starts at most {}", program.name(),
                              groups[axis], "xyz"[axis], state.info.renderer, limit));
    }
  }
  state.bind(program, bindings);
  glDispatchCompute(groups.x, groups.y, groups.z);
  if (state.messages.hasErrors()) state.check("dispatching " + program.name());
}

void Device::dispatchIndirect(const Program& program, std::span<const ResourceBinding> bindings,
                              const Buffer& arguments, std::uint64_t offsetBytes) {
  DeviceState& state = *state_;
  state.use();
  assert(offsetBytes % 4 == 0 && offsetBytes + 12 <= arguments.sizeBytes());
  state.bind(program, bindings);
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, arguments.handle());
  glDispatchComputeIndirect(static_cast<GLintptr>(offsetBytes));
  if (state.messages.hasErrors()) state.check("dispatching " + program.name());
}

Drawing Device::drawTo(const RenderTargets& targets, const RasterState& raster) {
  DeviceState& state = *state_;
  state.use();
  assert(!state.drawing && "one drawing at a time");
  assert(targets.samples == 1 || (targets.colours.empty() && targets.depth == nullptr));
  if (targets.samples < 1 || targets.samples > state.info.maxSamples) refuseSamples(state, targets.samples);
  const float depthBiasScale = raster.depthBiasConstant != 0.0f ? state.depthBiasScale() : 1.0f;
  const glm::ivec2 size = sizeOf(targets);
  keyOf(targets, size, state.framebufferKey);
  std::optional<GLuint> known = state.framebuffers.find(state.framebufferKey);
  if (!known) {
    known = makeFramebuffer(state, targets, size);
    state.framebuffers.keep(state.framebufferKey, *known);
  }
  const GLuint framebuffer = *known;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  state.drawing = true;
  glViewport(0, 0, size.x, size.y);
  if (targets.clear) {
    clearTargets(framebuffer, targets);
    state.transfers.cleared += clearedBytes(targets);
  }
  setRasterState(raster, depthBiasScale);
  return Drawing(state_);
}

void Device::drawIndexed(const Program& program, std::span<const ResourceBinding> bindings,
                         const Buffer& indices, std::uint32_t firstIndex, std::uint32_t indexCount) {
  DeviceState& state = *state_;
  state.use();
  assert(state.drawing);
  assert((std::uint64_t{firstIndex} + indexCount) * 4 <= indices.sizeBytes());
  state.bind(program, bindings);
  if (state.elementBuffer != indices.handle()) {
    state.elementBuffer = indices.handle();
    glVertexArrayElementBuffer(state.vertexArray, state.elementBuffer);
  }
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(indexCount), GL_UNSIGNED_INT,
                 reinterpret_cast<const void*>(std::uintptr_t{firstIndex} * 4));
  if (state.messages.hasErrors()) state.check("drawing " + program.name());
}

void Device::draw(const Program& program, std::span<const ResourceBinding> bindings,
                  std::uint32_t vertexCount) {
  DeviceState& state = *state_;
  state.use();
  assert(state.drawing);
  state.bind(program, bindings);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertexCount));
  if (state.messages.hasErrors()) state.check("drawing " + program.name());
}

Drawing::~Drawing() {
  device_->use();
  assert(device_->drawing);
  device_->drawing = false;
  // No later command must find its textures attached.
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

std::vector<glm::vec2> Device::samplePositions(int samples) {
  DeviceState& state = *state_;
  state.use();
  assert(!state.drawing);
  if (samples < 1 || samples > state.info.maxSamples) refuseSamples(state, samples);
  std::vector<glm::vec2> positions(static_cast<std::size_t>(samples), glm::vec2(0.5f));
  if (samples == 1) return positions;
  // Drivers report them for a framebuffer with an attachment; the values hold without one too.
  GLuint framebuffer = 0, target = 0;
  glCreateRenderbuffers(1, &target);
  glNamedRenderbufferStorageMultisample(target, samples, GL_RGBA8, 1, 1);
  glCreateFramebuffers(1, &framebuffer);
  glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  for (int i = 0; i < samples; ++i)
    glGetMultisamplefv(GL_SAMPLE_POSITION, static_cast<GLuint>(i), &positions[static_cast<std::size_t>(i)].x);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glDeleteFramebuffers(1, &framebuffer);
  glDeleteRenderbuffers(1, &target);
  state.check("asking for the positions of samples");
  return positions;
}

void Device::barrier() {
  state_->use();
  state_->order();
}

void Device::finish() {
  state_->use();
  glFinish();
  state_->underWay = false;
  state_->check("running the device's commands");
}

}  // namespace lumivox::gpu
