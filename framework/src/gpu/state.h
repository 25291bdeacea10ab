// The OpenGL side of a Device, which the files of this part share. Nothing outside framework/src/gpu includes
// it.
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "gpu/driver_messages.h"
#include "gpu/memory.h"
#include "gpu/uniform_ring.h"
#include "lumivox/gpu/device.h"

namespace lumivox::gpu {

/// A Format in the terms of OpenGL.
struct FormatTraits {
  GLenum internal;  ///< sized internal format
  GLenum external;  ///< layout of the components in memory
  GLenum type;      ///< of one component in memory
  int components;
  int bytesPerTexel;
  bool integer, depth;
  const char* name;
};
const FormatTraits& traitsOf(Format format);

/// Links a program for the device's own use from GLSL texts that every driver accepts: for each stage, the
/// pieces of its text.
GLuint linkProgram(std::initializer_list<std::pair<GLenum, std::vector<const char*>>> stages);

/// An OpenGL 4.5 core context without a display.
class Context {
 public:
  /// AbsentError if no device of this machine meets the request; Error if the request is invalid.
  Context(const std::string& request, bool debug);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  /// Error if the driver refuses.
  void makeCurrent() const;
  bool tryMakeCurrent() const noexcept;
  const std::string& platform() const { return platform_; }

 private:
  bool tryDisplay(void* display, const std::string& platform, std::string& failures);
  void destroy();

  bool debug_;
  void* display_ = nullptr;
  void* context_ = nullptr;
  std::string platform_;
};
/// Whether the current context draws on the processor.
bool isSoftwareRenderer(const std::string& renderer);

/// The buffer behind a UniformRing.
class UniformBuffer : public UniformRing::Fences {
 public:
  UniformBuffer() = default;
  UniformBuffer(const UniformBuffer&) = delete;
  UniformBuffer& operator=(const UniformBuffer&) = delete;
  void create(std::size_t alignment);
  void destroy();
  UniformRing& ring() { return *ring_; }
  /// Copies a block to the next place in the ring and returns its offset.
  GLintptr write(std::span<const std::byte> block);
  GLuint handle() const { return buffer_; }

 private:
  void insert(std::size_t segment) override;
  void wait(std::size_t segment) override;

  GLuint buffer_ = 0;
  std::byte* mapped_ = nullptr;
  std::optional<UniformRing> ring_;
  std::array<GLsync, UniformRing::kSegments> fences_{};
};

/// Identifies a framebuffer: handle and layer of each colour target and of depth; without targets, size and
/// samples. Plain words, so that keys compare as a whole.
using FramebufferKey = std::vector<std::int64_t>;

/// Framebuffers that were already made and checked.
class FramebufferCache {
 public:
  std::optional<GLuint> find(const FramebufferKey& key) const;
  void keep(const FramebufferKey& key, GLuint framebuffer);
  /// Call it when a texture is deleted: no framebuffer may keep it or be mistaken for one with the next
  /// texture of the same name.
  void forget(GLuint texture);
  void clear();
  std::size_t size() const { return framebuffers_.size(); }

 private:
  std::map<FramebufferKey, GLuint> framebuffers_;
};

/// Linked programs by their contents. A second request for the same contents, at the same time or later, gets
/// the linked program: each executor has its own passes, and linking often takes longer than running.
class ProgramCache {
 public:
  struct Linked {
    GLuint handle = 0;
    glm::ivec3 groupSize{0};
  };
  /// Adds a holder; nothing if the program is not there.
  std::optional<Linked> hold(const ContentHash& contents);
  /// Adds a new program with its first holder.
  void keep(const ContentHash& contents, const Linked& linked);
  /// Removes a holder. A program without holders stays for the next request; if too many stay, the oldest is
  /// deleted. Returns whether one was deleted: its name may then be reused.
  bool release(GLuint handle);
  void clear();

 private:
  struct Entry {
    ContentHash contents;
    Linked linked;
    std::size_t holders = 0;
    std::uint64_t waitsSince = 0;  ///< in releases
  };
  std::map<ContentHash, GLuint> handles_;
  std::unordered_map<GLuint, Entry> entries_;
  std::map<std::uint64_t, GLuint> waiting_;  ///< by waitsSince
  std::uint64_t releases_ = 0;
};

/// The current bindings, so that a draw binds only differences from the previous one.
struct BindingCache {
  struct Sampled {
    GLuint texture = 0, sampler = 0;
  };
  struct Image {
    GLuint texture = 0;
    int level = 0;
  };
  struct Uniform {
    std::vector<std::byte> bytes;
    std::uint64_t segmentSerial = 0;  ///< of the ring, when they were written
  };
  GLuint program = 0;
  std::vector<Sampled> sampled;
  std::vector<Image> images;
  std::vector<GLuint> storage;
  std::vector<Uniform> uniforms;
};

/// Read-only resources by their contents, while they have holders.
template <class Resource>
using SharedResources = std::map<ContentHash, std::weak_ptr<const Resource>>;

struct DeviceLimits {
  GLint textureSize2d = 0, textureLayers = 0, textureSize3d = 0;
  GLint64 storageBlockBytes = 0;
  GLint uniformBlockBytes = 0, uniformAlignment = 256;
  std::array<GLint, 3> groupCount{};
  GLint sampledUnits = 0, imageUnits = 0, storageUnits = 0, uniformUnits = 0;
  GLint timestampBits = 0;  ///< bits of the counter behind time stamps; 0: the device has none
  std::uint64_t downloadBytes =
      std::numeric_limits<GLsizei>::max();  ///< most bytes of a texture that one command downloads
};

struct DeviceState {
  explicit DeviceState(const DeviceOptions& options);
  ~DeviceState();

  /// Makes the context current if another Device was used last on this thread.
  void use() { context.makeCurrent(); }
  /// The same for destructors. False if the context is lost or cannot be made current: its resources are gone
  /// with it, and there is nothing to release.
  bool useToRelease() noexcept { return !lost && context.tryMakeCurrent(); }
  /// Throws the driver's errors since the last check; `what` names the work. Without a debug context this
  /// queries the driver and waits for one that works on another thread.
  void check(const std::string& what);
  /// The same for errors that the driver reported by itself. It costs nothing and is called for every draw.
  void checkTold(const std::string& what) {
    if (messages.hasErrors()) check(what);
  }
  /// Throws if the context is lost. `errorTold`: the driver reported GL_CONTEXT_LOST.
  void requireContext(const std::string& what, bool errorTold);
  /// Throws Error if an allocation exceeds the free memory of the device or, with the present allocations,
  /// its limit.
  void requireDeviceMemory(std::uint64_t bytes, const std::string& what);
  /// Throws Error if a copy of so many bytes does not fit into the host's memory.
  static void requireHostMemory(std::uint64_t bytes, const std::string& label);
  /// " beside the 1.5 GiB of all other textures and buffers"
  std::string besideText() const;
  void downloaded(std::uint64_t bytes);
  void allocated(const void* resource, std::uint64_t bytes);
  void freed(const void* resource, std::uint64_t bytes);
  void bind(const Program& program, std::span<const ResourceBinding> bindings);
  /// Call it before a copy or clear: makes the writes of shaders visible to it, unless a barrier already did.
  void order();
  /// Call it when a resource is deleted: OpenGL unbinds it and may reuse its name, so cached bindings are
  /// invalid.
  void forgetBindings();
  /// Compares timer queries with the fenced clock, once.
  void checkTimers();
  /// The factor from a depth bias in units of 2^(e - 23), e the exponent of the depth, to this driver's unit.
  /// Measured once, by a draw of its own.
  float depthBiasScale();

  Context context;
  DeviceInfo info;
  ShaderInput shaderInput = ShaderInput::glsl;
  DeviceLimits limits;
  const std::uint64_t memoryBytes;  ///< limit of allocatedBytes; 0: the device's own
  std::string pass;
  const bool debug;             ///< a debug context
  bool tellsResets = false;     ///< the context reports resets of the device
  std::optional<Reset> lost{};  ///< the context is
  const Arithmetic arithmetic;
  DriverMessages messages;
  std::uint64_t allocatedBytes = 0, peakBytes = 0;
  std::shared_ptr<MemoryAccount> account;  ///< charged for allocations; null: none
  std::unordered_map<const void*, std::shared_ptr<MemoryAccount>> charged;  ///< by live resource
  SharedResources<Texture> sharedTextures;
  SharedResources<Buffer> sharedBuffers;
  Device::Transfers transfers;
  bool underWay = false;  ///< dispatches or draws since the last finish()
  std::array<GLuint, 8> samplers{};
  GLuint vertexArray = 0;
  GLuint elementBuffer = 0;
  bool drawing = false;
  bool unordered = false;  ///< shaders that may write ran since the last barrier
  FramebufferCache framebuffers;
  ProgramCache programs;
  FramebufferKey framebufferKey;  ///< of the last draw; a member to reuse its memory
  UniformBuffer uniforms;
  BindingCache cache;
  bool timersChecked = false;
  std::array<GLuint, 2> timestampQueries{};
  std::optional<float> foundDepthBiasScale;

 private:
  void readLimits();
  void requireLimits() const;  ///< AbsentError naming every limit that is too low
  void listen();               ///< to what the driver says
  void makeSamplers();
};

}  // namespace lumivox::gpu
