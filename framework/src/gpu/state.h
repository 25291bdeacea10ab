// The OpenGL side of a Device: what the files of this part share. Nothing outside framework/src/gpu includes
// it.
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

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

/// An OpenGL 4.5 core context without a display.
class Context {
 public:
  /// AbsentError when nothing on this machine meets the request; Error when the request makes no sense.
  explicit Context(const std::string& request);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  void makeCurrent() const;
  const std::string& platform() const { return platform_; }

 private:
  bool tryDisplay(void* display, const std::string& platform, std::string& failures);

  void* display_ = nullptr;
  void* context_ = nullptr;
  std::string platform_;
};
/// Whether the current context draws on the processor.
bool isSoftwareRenderer(const std::string& renderer);

/// Uniform blocks of draws in flight. A segment is written again only after the device has read it.
class UniformRing {
 public:
  void create(std::size_t alignment);
  void destroy();
  /// Copies the block into the ring; its offset there.
  GLintptr write(std::span<const std::byte> block);
  GLuint buffer() const { return buffer_; }
  /// Changes whenever the ring moves on to another segment; offsets of the current segment stay valid.
  std::uint64_t segmentSerial() const { return segmentSerial_; }

 private:
  static constexpr std::size_t kSegmentBytes =
      256 << 10;  // at least four times the largest block that OpenGL guarantees, 16 KiB
  static constexpr std::size_t kSegments = 4;
  GLuint buffer_ = 0;
  std::byte* mapped_ = nullptr;
  std::size_t alignment_ = 256, head_ = 0;
  std::uint64_t segmentSerial_ = 0;
  std::array<GLsync, kSegments> fences_{};
};

/// What is bound now, so that a draw binds only what differs from the one before.
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
    std::uint64_t segmentSerial = 0;
  };
  GLuint program = 0;
  std::vector<Sampled> sampled;
  std::vector<Image> images;
  std::vector<GLuint> storage;
  std::vector<Uniform> uniforms;
};

struct DeviceLimits {
  GLint textureSize2d = 0, textureLayers = 0, textureSize3d = 0;
  GLint64 storageBlockBytes = 0;
  GLint uniformBlockBytes = 0, uniformAlignment = 256;
  std::array<GLint, 3> groupCount{};
  GLint sampledUnits = 0, imageUnits = 0, storageUnits = 0, uniformUnits = 0;
};

struct DeviceState {
  explicit DeviceState(const DeviceOptions& options);
  ~DeviceState();

  /// Makes the context current when another Device was used last on this thread.
  void use();
  /// Throws what the driver complained about since the last check, naming `what` was being done.
  void check(const std::string& what);
  /// Refuses an allocation that does not fit into what the device has left, or into its limit together with
  /// what is held already.
  void requireDeviceMemory(std::uint64_t bytes, const std::string& what);
  /// Refuses to copy so many bytes of a resource to the host when they do not fit there.
  static void requireHostMemory(std::uint64_t bytes, const std::string& label);
  /// " beside the 1.5 GiB of all other textures and buffers"
  std::string besideText() const;
  void downloaded(std::uint64_t bytes);
  void allocated(std::uint64_t bytes);
  void freed(std::uint64_t bytes);
  void bind(const Program& program, std::span<const ResourceBinding> bindings);
  /// Deleting a resource unbinds it and frees its name for reuse: what the cache remembers is void.
  void forgetBindings();
  /// Compares timer queries with the fenced clock, once.
  void checkTimers();

  Context context;
  DeviceInfo info;
  ShaderInput shaderInput = ShaderInput::glsl;
  DeviceLimits limits;
  const std::uint64_t memoryBytes;  ///< limit of allocatedBytes; 0: none but the device's own
  std::string pass;
  std::vector<std::string> driverErrors;
  std::uint64_t allocatedBytes = 0, peakBytes = 0;
  Device::Transfers transfers;
  bool underWay = false;  ///< dispatches or draws since the last finish()
  std::array<GLuint, 7> samplers{};
  GLuint vertexArray = 0;
  GLuint elementBuffer = 0;
  GLuint framebuffer = 0;  ///< of the drawing in progress
  bool drawing = false;
  UniformRing uniforms;
  BindingCache cache;
  bool timersChecked = false;
  std::array<GLuint, 2> timestampQueries{};

 private:
  void readLimits();
  void makeSamplers();
};

}  // namespace lumivox::gpu
