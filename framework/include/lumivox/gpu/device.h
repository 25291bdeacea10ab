// The interface to OpenGL: an OpenGL 4.5 core context without a display, its resources and the commands on
// them. No OpenGL name appears in this header. A Device is used only on the thread that made it.
//
// Conventions for shader authors:
// - Clip space: x to the right, y UP, z from 0 (near) to 1 (far), as glm::perspectiveRH_ZO gives. Row 0
//   of a rendered image is its TOP (clip y = +1), so texel (x, y) means the same in raster passes
//   (gl_FragCoord), compute passes and sampled textures: texture coordinates of a clip position are u = 0.5 +
//   0.5 x, v = 0.5 - 0.5 y. Front faces stay counter-clockwise with y up.
// - Nothing is culled. The depth test passes where depth <= stored. Depth buffers clear to 1, colours to 0.
// - Bindings of sampled textures, images, storage buffers and uniform blocks are four separate number spaces.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace lumivox::gpu {

enum class Format {
  r8,
  rgba8,
  r16f,
  rg16f,
  rgba16f,
  r32f,
  rg32f,
  rgba32f,
  r32ui,
  rg32ui,
  rgba32ui,
  depth32f
};
std::size_t bytesPerTexel(Format format);
int componentCount(Format format);
const char* name(Format format);  ///< as in GLSL: "rgba16f"

enum class TextureKind { d2, d2Array, d3 };

struct TextureDescription {
  TextureKind kind = TextureKind::d2;
  Format format = Format::rgba16f;
  int width = 1, height = 1, depth = 1;  ///< depth: layers of an array, slices of a volume
  int levels = 1;                        ///< mip levels
  bool operator==(const TextureDescription&) const = default;
  std::uint64_t sizeBytes() const;
};

/// Number of mip levels down to one texel.
int fullLevelCount(int width, int height, int depth = 1);

class Device;
struct DeviceState;

/// A texture with immutable storage. Allocation is refused with an Error that names the size when it cannot
/// fit.
class Texture {
 public:
  Texture(Device& device, const TextureDescription& description, std::string label = {});
  ~Texture();
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  const TextureDescription& description() const { return description_; }
  std::uint64_t sizeBytes() const { return description_.sizeBytes(); }
  const std::string& label() const { return label_; }

  /// All texels of one level, tightly packed in the texture's own format, row 0 first.
  void upload(int level, std::span<const std::byte> texels);
  std::vector<std::byte> download(int level = 0) const;
  /// Slices (layers of an array) `first` to `first + count - 1` of one level, packed as `download` packs
  /// them, into `texels`, which has exactly their size: a volume can be read through one small buffer.
  void downloadSlices(int level, int first, int count, std::span<std::byte> texels) const;
  /// Every format but the integer ones, as floats: texel-major, `components` of the format (half floats
  /// widened, bytes divided by 255).
  std::vector<float> downloadFloats(int level = 0) const;
  void uploadFloats(int level, std::span<const float> values);
  /// Fills every texel of a level (all levels when -1). Integer formats take the value rounded.
  void clear(const glm::vec4& value, int level = -1);
  /// Box-filtered mips made by the driver; for surface textures only.
  void generateLevels();

  std::uint32_t handle() const { return handle_; }  ///< for framework/src/gpu alone

 private:
  std::shared_ptr<DeviceState> device_;
  TextureDescription description_;
  std::string label_;
  std::uint32_t handle_ = 0;
};

class Buffer {
 public:
  Buffer(Device& device, std::uint64_t sizeBytes, std::string label = {});
  ~Buffer();
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  std::uint64_t sizeBytes() const { return sizeBytes_; }
  const std::string& label() const { return label_; }
  void upload(std::span<const std::byte> bytes, std::uint64_t offsetBytes = 0);
  std::vector<std::byte> download(std::uint64_t offsetBytes = 0,
                                  std::uint64_t sizeBytes = ~std::uint64_t{0}) const;
  void clear(std::uint32_t word = 0);  ///< fills with one 32-bit word

  template <class T>
  void uploadValues(std::span<const T> values) {
    upload(std::as_bytes(values));
  }
  template <class T>
  std::vector<T> downloadValues() const {
    const std::vector<std::byte> bytes = download();
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
  }

  std::uint32_t handle() const { return handle_; }  ///< for framework/src/gpu alone

 private:
  std::shared_ptr<DeviceState> device_;
  std::uint64_t sizeBytes_;
  std::string label_;
  std::uint32_t handle_ = 0;
};

using TextureRef = std::shared_ptr<Texture>;
using BufferRef = std::shared_ptr<Buffer>;

/// How a texture is read. Without `repeat` or `border` the edge texel continues outside; `border` means zero
/// outside; `shadow` compares depth (1 where reference <= stored) and filters the four results.
/// `linearOneMip` reads the nearest mip level alone, so that the next one may be written meanwhile. Integer
/// formats are read with `nearest` only.
enum class Sampling {
  nearest,
  linear,
  linearMips,
  linearMipsRepeat,
  linearBorder,
  linearMipsBorder,
  shadow,
  linearOneMip
};

// ---- programs
// -------------------------------------------------------------------------------------------------------------------

enum class Stage { vertex, geometry, fragment, compute };

/// The code of one stage: SPIR-V words for drivers with ARB_gl_spirv, and GLSL text made from the same words.
struct StageCode {
  Stage stage;
  std::span<const std::uint32_t> spirv;
  std::string_view glsl;
};
/// Value of a specialisation constant, as the 32 bits of its type.
struct SpecialisationValue {
  std::uint32_t id;
  std::uint32_t bits;
};

enum class ShaderInput { automatic, spirv, glsl };

/// A driver's freedom in sums and products. `exact`: neither fused nor reordered, so that all drivers and
/// both routes give the same bits. `fast`: everything that OpenGL allows, as in a released renderer, for
/// timing.
enum class Arithmetic { exact, fast };

/// A linked program. Errors carry the driver's log and the name.
class Program {
 public:
  Program(Device& device, std::string name, std::span<const StageCode> stages,
          std::span<const SpecialisationValue> constants);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  const std::string& name() const { return name_; }
  /// Invocations of a work group along each axis; 0 without a compute stage.
  const glm::ivec3& groupSize() const { return groupSize_; }
  std::uint32_t handle() const { return handle_; }

 private:
  std::shared_ptr<DeviceState> device_;
  std::string name_;
  std::uint32_t handle_ = 0;
  glm::ivec3 groupSize_{0};
};

// ---- commands
// -------------------------------------------------------------------------------------------------------------------

/// The bytes of a uniform block. Small blocks are stored inside the object, so that a draw allocates nothing.
class BlockBytes {
 public:
  BlockBytes() = default;
  template <class Iterator>
  BlockBytes(Iterator first, Iterator last) : size_(static_cast<std::size_t>(last - first)) {
    if (size_ > kWithin) {
      beyond_.assign(first, last);
    } else {
      std::copy(first, last, within_.begin());
    }
  }
  explicit BlockBytes(std::span<const std::byte> bytes) : BlockBytes(bytes.begin(), bytes.end()) {}
  std::span<const std::byte> bytes() const {
    return size_ > kWithin ? std::span<const std::byte>(beyond_) : std::span(within_).first(size_);
  }
  std::size_t size() const { return size_; }

 private:
  static constexpr std::size_t kWithin = 128;  // a matrix and as much again
  std::size_t size_ = 0;
  std::array<std::byte, kWithin> within_{};
  std::vector<std::byte> beyond_;
};

/// One resource at one binding point of a program. Made by the slots in shader/slots.h, so that names and
/// kinds are checked.
struct ResourceBinding {
  struct Sampled {
    const Texture* texture;
    Sampling sampling;
  };
  struct StorageImage {
    const Texture* texture;
    int level;
  };
  struct Storage {
    const Buffer* buffer;
  };
  struct Uniform {
    BlockBytes bytes;
  };
  const char* name = "";
  std::uint32_t binding = 0;
  std::variant<Sampled, StorageImage, Storage, Uniform> resource;
};

struct RasterState {
  bool depthTest = false, depthWrite = false, depthClamp = false;
  float depthBiasSlope = 0.0f, depthBiasConstant = 0.0f;  ///< polygon offset
};

struct ColourTarget {
  const Texture* texture;
  int layer = -1;
};

/// Where drawing goes. With no target at all, width and height give the size of an empty framebuffer
/// (voxelization).
struct RenderTargets {
  std::vector<ColourTarget> colours{};  ///< one per output location; null texture: that output is not kept
  const Texture* depth = nullptr;
  int depthLayer = -1;
  int width = 0, height = 0;
  int samples = 1;    ///< of an empty framebuffer; above 1, a fragment sees in gl_SampleMaskIn what it covers
  bool clear = true;  ///< colours to 0, depth to 1
};

/// A scope in which draws go to its targets. Its destructor unbinds them, also when an exception passes. Made
/// by Device::drawTo; one at a time.
class [[nodiscard]] Drawing {
 public:
  ~Drawing();
  Drawing(const Drawing&) = delete;
  Drawing& operator=(const Drawing&) = delete;

 private:
  friend class Device;
  explicit Drawing(std::shared_ptr<DeviceState> device) : device_(std::move(device)) {}
  std::shared_ptr<DeviceState> device_;
};

struct DeviceInfo {
  std::string vendor, renderer, version;  ///< the driver's own words
  std::string platform;                   ///< "EGL device 0", "EGL surfaceless", ...
  bool software = false;                  ///< a software rasteriser
  bool spirv = false;                     ///< ARB_gl_spirv usable
  bool timerQueriesTrusted = false;       ///< after the check against the fenced clock
  std::string timerNote;                  ///< what that check found
  int maxTextureSize3d = 0;
  std::uint64_t maxStorageBytes = 0;
  int maxSamples = 1;    ///< of an empty framebuffer
  int vertexImages = 0;  ///< that a vertex shader may store to
};

struct DeviceOptions {
  std::string device = "auto";  ///< "auto", "software", "surfaceless", or the index of an EGL device
  ShaderInput shaderInput = ShaderInput::automatic;
  std::uint64_t memoryBytes = 0;  ///< textures and buffers may take so much together; 0: what the device has
  Arithmetic arithmetic = Arithmetic::exact;
  /// A context in which the driver explains every error at the command that made it, at the cost of time.
  /// Without it errors are reported when the device is waited for. Default: whether $LUMIVOX_DEBUG_CONTEXT is
  /// set.
  bool debugContext = debugContextAsked();
  static bool debugContextAsked();
};

class Device {
 public:
  /// Makes the context current on this thread. AbsentError when there is no EGL or no OpenGL 4.5, or when the
  /// device lacks something that docs/gpu.md asks for: it names it.
  explicit Device(const DeviceOptions& options = {});
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const;
  ShaderInput shaderInput() const;  ///< spirv or glsl, never automatic
  Arithmetic arithmetic() const;
  /// How programs reach the driver, as records name it: "spirv", "glsl", "spirv fast", "glsl fast".
  std::string programRoute() const;

  /// Every command between enter and leave belongs to this pass: the driver's messages are logged under its
  /// name. Errors do not contain the name; the caller adds it.
  void enterPass(const std::string& name);
  void leavePass();  ///< in a debug context: throws Error for a driver error since enterPass

  void dispatch(const Program& program, std::span<const ResourceBinding> bindings, glm::uvec3 groups);
  /// Group counts read from three words of `arguments` at `offsetBytes`.
  void dispatchIndirect(const Program& program, std::span<const ResourceBinding> bindings,
                        const Buffer& arguments, std::uint64_t offsetBytes = 0);

  /// Binds targets and state for the draws while the returned object lives. Viewport = the whole target.
  /// Neither its draws nor any other command may read the targets before it ends.
  Drawing drawTo(const RenderTargets& targets, const RasterState& state);
  /// Indexed triangles (32-bit indices); attributes are pulled from storage buffers by gl_VertexID.
  void drawIndexed(const Program& program, std::span<const ResourceBinding> bindings, const Buffer& indices,
                   std::uint32_t firstIndex, std::uint32_t indexCount);
  void draw(const Program& program, std::span<const ResourceBinding> bindings, std::uint32_t vertexCount);
  /// Where an empty framebuffer of so many samples takes them, in the order of the bits of gl_SampleMaskIn:
  /// x and y inside the pixel, 0..1, in the direction of gl_FragCoord. Error when the device has fewer.
  std::vector<glm::vec2> samplePositions(int samples);

  /// Makes all earlier writes visible to all later reads (also to download, indirect arguments and texture
  /// fetches).
  void barrier();
  void finish();  ///< waits until the device is idle; throws Error for a driver error since the last time

  /// Milliseconds that `work` took: {host, device}, for work that is long beside its submission. The device
  /// time comes from a timer query where those are trusted, else from the fenced clock (finish before and
  /// after). It waits for the device; the passes of a frame are timed by PassTimers.
  struct Elapsed {
    double hostMs, deviceMs;
  };
  Elapsed time(const std::function<void()>& work);

  /// Bytes that were moved or filled by commands that are no shader's, since the device was made.
  struct Transfers {
    std::uint64_t uploaded = 0, downloaded = 0, cleared = 0;
    /// The number of downloads since the last finish() while dispatches or draws were under way: at each the
    /// host waited for all of them.
    std::uint64_t stalls = 0;
  };
  Transfers transfers() const;

  /// Bytes in textures and buffers that are alive now, and the most so far.
  std::uint64_t allocatedBytes() const;
  std::uint64_t peakBytes() const;
  void resetPeak();

  const std::shared_ptr<DeviceState>& state() { return state_; }  ///< for framework/src/gpu alone

 private:
  std::shared_ptr<DeviceState> state_;  ///< shared with the resources, which may outlive the Device
};

/// Device::programRoute() in words: "SPIR-V", "GLSL made from the SPIR-V, fast arithmetic".
std::string programRouteText(const Device& device);

/// Device times of the parts of frames, from time stamps that are read several frames later: nothing waits
/// between parts or frames. DeviceInfo::timerQueriesTrusted says whether the time stamps can be trusted.
class PassTimers {
 public:
  /// So many frames may be under way; a further one waits for the oldest.
  explicit PassTimers(Device& device, std::size_t framesUnderWay = 4);
  ~PassTimers();
  PassTimers(const PassTimers&) = delete;
  PassTimers& operator=(const PassTimers&) = delete;

  void beginFrame();  ///< forgets a frame that was not ended
  void begin();       ///< of the next part
  void end();
  void endFrame();
  using Frame = std::vector<double>;  ///< ms of its parts
  /// The frames whose times were read since the last call, in their order.
  std::vector<Frame> take();
  /// The same of all frames: waits for the device.
  std::vector<Frame> takeAll();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lumivox::gpu
