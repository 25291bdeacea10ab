// The OpenGL side of a Device: what the files of this part share. Nothing outside framework/src/gpu includes
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

/// How OpenGL names a Format.
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

/// A program of the device's own, from GLSL texts that every driver takes: of each stage the pieces of its
/// text.
GLuint linkProgram(std::initializer_list<std::pair<GLenum, std::vector<const char*>>> stages);

/// An OpenGL 4.5 core context without a display.
class Context {
 public:
  /// AbsentError when nothing on this machine meets the request; Error when the request makes no sense.
  Context(const std::string& request, bool debug);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  /// Error where the driver refuses.
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
  /// Copies a block to the next place in the ring; its offset.
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

/// The targets of a framebuffer: handle and layer of each colour target and of depth, and the size and
/// samples of one without targets. Words, so that it is compared as a whole.
using FramebufferKey = std::vector<std::int64_t>;

/// Framebuffers that were made and checked before.
class FramebufferCache {
 public:
  std::optional<GLuint> find(const FramebufferKey& key) const;
  void keep(const FramebufferKey& key, GLuint framebuffer);
  /// A texture dies: no framebuffer may keep it, nor be taken for one with the next texture of its name.
  void forget(GLuint texture);
  void clear();
  std::size_t size() const { return framebuffers_.size(); }

 private:
  std::map<FramebufferKey, GLuint> framebuffers_;
};

/// Linked programs by what they were made of. Who asks for the same again, beside the first or after it, gets
/// the linked one: each executor has passes of its own, and a driver takes longer to link than to run many of
/// them.
class ProgramCache {
 public:
  struct Linked {
    GLuint handle = 0;
    glm::ivec3 groupSize{0};
  };
  /// With one more holder; none when it is not there.
  std::optional<Linked> hold(const ContentHash& contents);
  /// A new one, with its first holder.
  void keep(const ContentHash& contents, const Linked& linked);
  /// One holder less. What nobody holds waits for the next who asks, and goes when too many wait: the one
  /// that has waited longest. Whether one went, whose name may then be another's.
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

/// The current bindings, so that a draw binds only what differs from the one before.
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

/// Read-only resources by their contents, as long as somebody holds them.
template <class Resource>
using SharedResources = std::map<ContentHash, std::weak_ptr<const Resource>>;

struct DeviceLimits {
  GLint textureSize2d = 0, textureLayers = 0, textureSize3d = 0;
  GLint64 storageBlockBytes = 0;
  GLint uniformBlockBytes = 0, uniformAlignment = 256;
  std::array<GLint, 3> groupCount{};
  GLint sampledUnits = 0, imageUnits = 0, storageUnits = 0, uniformUnits = 0;
  GLint timestampBits = 0;  ///< of the counter behind time stamps; 0: there are none
  std::uint64_t downloadBytes = std::numeric_limits<GLsizei>::max();  ///< of a texture, by one command
};

struct DeviceState {
  explicit DeviceState(const DeviceOptions& options);
  ~DeviceState();

  /// Makes the context current when another Device was used last on this thread.
  void use() { context.makeCurrent(); }
  /// The same for destructors. False: the context is lost, or cannot be made current, and what it held is
  /// gone with it, so that there is nothing to release.
  bool useToRelease() noexcept { return !lost && context.tryMakeCurrent(); }
  /// Throws what the driver complained about since the last check, naming `what` was being done. Without a
  /// debug context it must ask for that, for which a driver that works on another thread is waited for.
  void check(const std::string& what);
  /// The same for what it told of its own accord, which costs nothing: for every draw.
  void checkTold(const std::string& what) {
    if (messages.hasErrors()) check(what);
  }
  /// Throws when the context was lost, of which the driver may have told by an error (GL_CONTEXT_LOST).
  void requireContext(const std::string& what, bool errorTold);
  /// Refuses an allocation that does not fit into what the device has left, or into its limit together with
  /// what is held already.
  void requireDeviceMemory(std::uint64_t bytes, const std::string& what);
  /// Refuses to copy so many bytes of a resource to the host when they do not fit there.
  static void requireHostMemory(std::uint64_t bytes, const std::string& label);
  /// " beside the 1.5 GiB of all other textures and buffers"
  std::string besideText() const;
  void downloaded(std::uint64_t bytes);
  void allocated(const void* resource, std::uint64_t bytes);
  void freed(const void* resource, std::uint64_t bytes);
  void bind(const Program& program, std::span<const ResourceBinding> bindings);
  /// Before a command that moves or fills: makes what shaders wrote visible to it, unless a barrier did so
  /// already.
  void order();
  /// Deleting a resource unbinds it and frees its name for reuse: what the cache remembers is void.
  void forgetBindings();
  /// Compares timer queries with the fenced clock, once.
  void checkTimers();
  /// What a depth bias in units of 2^(e - 23), e the exponent of the depth, is multiplied by for this driver,
  /// which has a unit of its own. Found once; not while something is drawn.
  float depthBiasScale();

  Context context;
  DeviceInfo info;
  ShaderInput shaderInput = ShaderInput::glsl;
  DeviceLimits limits;
  const std::uint64_t memoryBytes;  ///< limit of allocatedBytes; 0: none but the device's own
  std::string pass;
  const bool debug;             ///< a debug context
  bool tellsResets = false;     ///< the context was made to tell when the device was reset
  std::optional<Reset> lost{};  ///< the context is
  const Arithmetic arithmetic;
  DriverMessages messages;
  std::uint64_t allocatedBytes = 0, peakBytes = 0;
  std::shared_ptr<MemoryAccount> account;  ///< charged for what is allocated now; null: none
  std::unordered_map<const void*, std::shared_ptr<MemoryAccount>> charged;  ///< by resource that is alive
  SharedResources<Texture> sharedTextures;
  SharedResources<Buffer> sharedBuffers;
  Device::Transfers transfers;
  bool underWay = false;  ///< dispatches or draws since the last finish()
  std::array<GLuint, 8> samplers{};
  GLuint vertexArray = 0;
  GLuint elementBuffer = 0;
  bool drawing = false;
  bool unordered = false;  ///< shaders ran since the last barrier, and may have written
  FramebufferCache framebuffers;
  ProgramCache programs;
  FramebufferKey framebufferKey;  ///< of the last drawing; a member for its memory
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
